#include "normalshop/io/detail/document_import.h"

#include <algorithm>
#include <system_error>

#include "normalshop/core/error.h"
#include "normalshop/core/options.h"
#include "normalshop/document/field_reader.h"
#include "normalshop/io/atomic_file.h"
#include "normalshop/io/file_assets.h"
#include "normalshop/io/staged_folder.h"

namespace normalshop {

namespace {

namespace fs = std::filesystem;

Value list_value(const std::vector<std::string>& texts) {
  return Value::Array(texts.begin(), texts.end());
}

/// What the conventions don't say already.
Value import_value(const OpenOptions& options) {
  return Value::Object{{"model", options.model.string()},
                       {"normal_maps", list_value(options.normal_maps)},
                       {"albedos", list_value(options.albedos)},
                       {"flip_v", options.flip_v},
                       {"size", options.size}};
}

std::vector<std::string> read_list(const FieldReader& reader) {
  std::vector<std::string> texts;
  for (const FieldReader& item : reader.items()) texts.push_back(item.text());
  return texts;
}

std::vector<StoredSet> sets_of(const OpenedDocument& opened) {
  std::vector<StoredSet> sets;
  for (std::size_t i = 0; i < opened.sets.size(); ++i) {
    const NormalMap& map = opened.document.storage().sets[i].normals;
    sets.push_back(
        {opened.model.texture_sets[i].name, map.width(), map.height(), map.convention()});
  }
  return sets;
}

/// Tiles fit no other maps than those that they were made on.
void check_sets(const std::vector<StoredSet>& imported, const DocumentFile& file) {
  const auto same = [](const StoredSet& a, const StoredSet& b) {
    return a.name == b.name && a.width == b.width && a.height == b.height &&
           a.convention == b.convention;
  };
  if (std::equal(imported.begin(), imported.end(), file.sets().begin(), file.sets().end(), same)) {
    return;
  }
  throw DocumentError("'" + file.path().string() +
                      "': the model that it holds does not give the texture sets that it was made "
                      "with; it is damaged or needs another version of NormalShop");
}

/// Reads, in order that it is recorded, what else an export of the model reads: files that no edit
/// needs, but the model names.
void read_companions(const Model& model, const fs::path& folder) {
  const StagedFolder rehearsal(folder);
  rehearsal.write([&] { write_model(model, rehearsal.path() / model.path.filename(), {}); });
}

/// Messages name the file that is wanted.
void create_in(const fs::path& temporary, const DocumentFile::Contents& contents,
               const fs::path& target) {
  try {
    DocumentFile::create(temporary, contents);
  } catch (const DocumentError& error) {
    std::string what = error.what();
    const std::size_t at = what.find(temporary.string());
    if (at != std::string::npos) what.replace(at, temporary.string().size(), target.string());
    throw DocumentError(what);
  }
}

}  // namespace

std::string RecordedFiles::read(const fs::path& path) const {
  std::string bytes = source_->read(path);
  files_.try_emplace(path.string(), std::make_shared<const std::string>(bytes));
  return bytes;
}

std::vector<NamedFile> RecordedFiles::files() const {
  std::vector<NamedFile> files;
  for (const auto& [name, bytes] : files_) files.push_back({name, bytes});
  return files;
}

bool HeldFiles::has(const fs::path& path) const { return file_->has_file(path.string()); }

std::string HeldFiles::read(const fs::path& path) const {
  // Like a file that is missing on the disk, which importers can live with.
  if (!has(path)) throw IoError("cannot read '" + path.string() + "': it is not in the document");
  return file_->read_file(path.string());
}

OpenOptions read_import(const std::shared_ptr<DocumentFile>& file) {
  OpenOptions options;
  try {
    const FieldReader reader(file->import(), "import");
    options.model = reader.required("model").text();
    options.normal_maps = read_list(reader.required("normal_maps"));
    options.albedos = read_list(reader.required("albedos"));
    options.flip_v = reader.required("flip_v").boolean();
    options.size = reader.required("size").whole_number(0, 16384);
  } catch (const InvalidInput& error) {
    throw DocumentError("'" + file->path().string() + "' is damaged: " + error.what());
  }
  options.files = std::make_shared<HeldFiles>(file);
  for (const StoredSet& set : file->sets()) options.conventions[set.name] = set.convention;
  return options;
}

std::vector<std::string> import_document(OpenOptions options, const fs::path& target,
                                         const Progress& progress,
                                         const std::function<void(OpenedDocument&)>& edit) {
  std::error_code error;
  if (fs::exists(target, error)) {
    throw DocumentError("'" + target.string() +
                        "' exists already; a new document takes no other's "
                        "place");
  }
  PendingFile pending(target);  // first, so that a folder that cannot be written costs no time
  const auto recorded = std::make_shared<RecordedFiles>(options.files);
  options.files = recorded;
  OpenedDocument opened = open_document(options, progress);
  progress.at(0.9, "writing the document");
  read_companions(opened.model, pending.path().parent_path());
  create_in(pending.path(), {import_value(options), recorded->files(), sets_of(opened)}, target);
  std::vector<std::string> notes = opened.notes;
  if (edit) {
    keep_in_file(opened, std::make_shared<DocumentFile>(pending.path()));
    edit(opened);
    opened.document = Document({}, {});  // closes the file
  }
  pending.commit();
  return notes;
}

void keep_in_file(OpenedDocument& opened, const std::shared_ptr<DocumentFile>& file) {
  check_sets(sets_of(opened), *file);
  opened.document.keep_in(file, [](std::vector<NamedFile> files) {
    return std::make_unique<FileAssets>(std::move(files));
  });
}

}  // namespace normalshop
