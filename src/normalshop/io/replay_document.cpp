#include "normalshop/io/replay_document.h"

#include <algorithm>

#include "normalshop/core/error.h"
#include "normalshop/io/detail/document_import.h"
#include "normalshop/io/file_assets.h"

namespace normalshop {

namespace {

namespace fs = std::filesystem;

/// What the document holds, and the disk for what it does not.
class HeldOrDisk : public FileSource {
 public:
  explicit HeldOrDisk(std::shared_ptr<const FileSource> held) : held_(std::move(held)) {}
  bool has(const fs::path& path) const override {
    return held_->has(path) || disk_files()->has(path);
  }
  std::string read(const fs::path& path) const override {
    return held_->has(path) ? held_->read(path) : disk_files()->read(path);
  }

 private:
  std::shared_ptr<const FileSource> held_;
};

/// A file given by the user, which may have changed since the document took one of that name.
void check_new(const DocumentFile& file, const std::string& path) {
  if (!file.has_file(path)) return;
  throw InvalidInput("the document holds a file '" + path +
                     "' already; give the new one by another name");
}

OpenOptions import_options(const std::shared_ptr<DocumentFile>& file, const ReplayOptions& wanted) {
  OpenOptions options = read_import(file);
  if (wanted.size > 0) options.size = wanted.size;
  if (!wanted.model.empty()) {
    options.model = fs::absolute(wanted.model);
    check_new(*file, options.model.string());
    options.flip_v = wanted.flip_v;
    options.normal_maps.clear();
    options.albedos.clear();
    options.files = disk_files();
  }
  if (!wanted.normal_maps.empty()) {
    options.normal_maps = wanted.normal_maps;
    for (const std::string& map : wanted.normal_maps)
      check_new(*file, map.substr(map.find('=') + 1));
  }
  // Other maps may mean something else.
  if (!wanted.model.empty() || !wanted.normal_maps.empty()) {
    options.conventions.clear();
    if (wanted.model.empty()) options.files = std::make_shared<HeldOrDisk>(options.files);
  }
  return options;
}

class Replay {
 public:
  Replay(const DocumentFile& source, bool skip_failing, const Progress& progress)
      : source_(source), skip_failing_(skip_failing), progress_(progress) {
    for (const Layer& layer : source.stack().layers) count_ += layer.recipes().size();
  }

  void make(Document& document) {
    const EditStack stack = source_.stack();
    for (std::size_t i = 0; i < stack.layers.size(); ++i) {
      const Layer& layer = stack.layers[i];
      if (i > 0) document.change({.step = StackStep::AddLayer, .name = layer.name});
      const std::int64_t made = document.stack().layers.back().id;
      document.choose_layer(made);
      for (const std::int64_t recipe : layer.recipes()) add(document, recipe);
      left_out_ += layer.edits.size() - layer.recipes().size();
      set_look(document, made, layer);
    }
  }

  std::vector<std::string> notes() const {
    std::vector<std::string> notes = notes_;
    if (left_out_ > 0)
      notes.push_back("edits that are disabled are not in the new document: " +
                      std::to_string(left_out_));
    return notes;
  }

 private:
  void add(Document& document, std::int64_t recipe) {
    progress_.at(static_cast<double>(done_++) / static_cast<double>(count_), "edits");
    FileAssets assets(source_.files_of(recipe));
    const Edit edit = read_edit(source_.edit(recipe), "step " + std::to_string(recipe), assets);
    try {
      document.apply(edit);
    } catch (const InvalidInput& error) {
      if (!skip_failing_) throw;
      notes_.push_back("left out: " + std::string(error.what()));
    }
  }
  static void set_look(Document& document, std::int64_t made, const Layer& layer) {
    if (layer.plain() && layer.blend == LayerBlend::Linear &&
        (made != first_layer || layer.name == EditStack().layers[0].name))
      return;
    StackChange look{.step = StackStep::SetLayer, .target = made};
    if (made == first_layer) look.name = layer.name;
    look.opacity = layer.opacity;
    look.blend = layer.blend;
    look.hidden = layer.hidden;
    document.change(look);
  }

  const DocumentFile& source_;
  bool skip_failing_;
  const Progress& progress_;
  std::size_t count_ = 0;
  std::size_t done_ = 0;
  std::size_t left_out_ = 0;
  std::vector<std::string> notes_;
};

}  // namespace

std::vector<std::string> replay_document(const fs::path& source, const ReplayOptions& wanted,
                                         const fs::path& target, const Progress& progress) {
  const auto file = std::make_shared<DocumentFile>(source);
  Replay replay(*file, wanted.skip_failing, progress);
  std::vector<std::string> notes =
      import_document(import_options(file, wanted), target, {},
                      [&](OpenedDocument& opened) { replay.make(opened.document); });
  for (std::string& note : replay.notes()) notes.push_back(std::move(note));
  return notes;
}

}  // namespace normalshop
