#include "normalshop/document/document_file.h"

#include <algorithm>
#include <system_error>

#include "normalshop/core/error.h"
#include "normalshop/core/options.h"
#include "normalshop/document/store/document_state.h"
#include "normalshop/document/store/packing.h"
#include "normalshop/document/store/schema.h"

namespace normalshop {

namespace {

namespace fs = std::filesystem;

/// Opened before anything is made of it.
fs::path checked(const fs::path& path) {
  check_document_file(path);
  return path;
}

bool has_log(const fs::path& path) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(log_of(path), error);
  return !error && size > 0;
}

void add_sets(const Database& database, const std::vector<StoredSet>& sets) {
  Statement row(database,
                "INSERT INTO texture_sets(id, name, width, height, space, green_down, two_channel, "
                "centred_code, signed_float, scale) VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?, ?)");
  for (std::size_t i = 0; i < sets.size(); ++i) {
    const StoredSet& set = sets[i];
    const NormalConvention& c = set.convention;
    row.bind(1, static_cast<std::int64_t>(i)).bind(2, std::string_view(set.name));
    row.bind(3, std::int64_t{set.width}).bind(4, std::int64_t{set.height});
    row.bind(5, name_of(c.space)).bind(6, std::int64_t{c.green_down});
    row.bind(7, std::int64_t{c.two_channel}).bind(8, std::int64_t{c.centred_code});
    row.bind(9, std::int64_t{c.signed_float}).bind_number(10, static_cast<double>(c.scale)).run();
  }
}

StoredSet read_set(const Database& database, const Statement& row, std::int64_t expected) {
  StoredSet set;
  set.name = std::string(row.bytes(1));
  set.width = static_cast<int>(row.integer(2));
  set.height = static_cast<int>(row.integer(3));
  NormalConvention& c = set.convention;
  if (row.integer(0) != expected || !from_name(row.bytes(4), c.space)) {
    database.fail("is damaged: its texture set " + std::to_string(expected) + " is missing");
  }
  c.green_down = row.integer(5) != 0;
  c.two_channel = row.integer(6) != 0;
  c.centred_code = row.integer(7) != 0;
  c.signed_float = row.integer(8) != 0;
  c.scale = static_cast<float>(row.number(9));
  return set;
}

}  // namespace

void DocumentFile::create(const fs::path& path, const Contents& contents) {
  if (!fs::exists(path)) {
    throw DocumentError("'" + path.string() + "' must be an empty file to begin a document in");
  }
  const Database database(path);
  if (database.read_only()) database.fail("is write-protected");
  create_schema(database);
  Transaction transaction(database);
  const std::string import = to_json(contents.import);
  Statement(database, "INSERT INTO document(id, written_by, import) VALUES(1, ?, ?)")
      .bind(1, std::string_view(NORMALSHOP_VERSION))
      .bind(2, std::string_view(import))
      .run();
  add_sets(database, contents.sets);
  const StoredFiles files(database);
  Statement name(database, "INSERT INTO imported_files(name, file) VALUES(?, ?)");
  for (const NamedFile& file : contents.files) {
    name.bind(1, std::string_view(file.name)).bind(2, files.add(*file.bytes)).run();
  }
  transaction.commit();
}

bool DocumentFile::is_one(const fs::path& path) { return is_document_file(path); }

DocumentFile::DocumentFile(const fs::path& path)
    : recovered_(has_log(path)), state_(std::make_unique<State>(checked(path))) {
  migrate(state_->database);
  read_head();
}

DocumentFile::~DocumentFile() = default;

void DocumentFile::read_head() {
  const Database& database = state_->database;
  Statement head(database, "SELECT import FROM document");
  if (!head.step()) database.fail("is damaged: its head is missing");
  try {
    import_ = parse_json(head.bytes(0), "import");
  } catch (const InvalidInput& error) {
    database.fail("is damaged: " + std::string(error.what()));
  }
  Statement row(database,
                "SELECT id, name, width, height, space, green_down, two_channel, centred_code, "
                "signed_float, scale FROM texture_sets ORDER BY id");
  while (row.step()) {
    sets_.push_back(read_set(database, row, static_cast<std::int64_t>(sets_.size())));
  }
}

const fs::path& DocumentFile::path() const { return state_->database.path(); }

bool DocumentFile::read_only() const { return state_->database.read_only(); }

std::vector<std::string> DocumentFile::notes() const {
  if (!recovered_) return {};
  return {"'" + path().string() +
          "' was not closed by the program that had it open last; every edit that was finished is "
          "there"};
}

bool DocumentFile::has_file(const std::string& name) const {
  Statement row(state_->database, "SELECT 1 FROM imported_files WHERE name = ?");
  return row.bind(1, std::string_view(name)).step();
}

std::string DocumentFile::read_file(const std::string& name) const {
  Statement row(state_->database, "SELECT file FROM imported_files WHERE name = ?");
  if (!row.bind(1, std::string_view(name)).step()) {
    state_->database.fail("does not hold '" + name + "'");
  }
  return state_->files.read(row.integer(0), name);
}

}  // namespace normalshop
