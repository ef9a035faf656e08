#include "normalshop/document/store/schema.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <string>

#include <fcntl.h>
#include <unistd.h>

#include "normalshop/core/error.h"

namespace normalshop {

namespace {

namespace fs = std::filesystem;

/// docs/document.md says what the tables mean.
constexpr const char* first_schema = R"(
CREATE TABLE document(
  id INTEGER PRIMARY KEY CHECK(id = 1),
  written_by TEXT NOT NULL,
  import TEXT NOT NULL,
  position INTEGER REFERENCES steps(id),
  first INTEGER REFERENCES steps(id));
CREATE TABLE files(
  id INTEGER PRIMARY KEY,
  size INTEGER NOT NULL,
  digest INTEGER NOT NULL);
CREATE INDEX files_by_digest ON files(digest, size);
CREATE TABLE file_parts(
  file INTEGER NOT NULL REFERENCES files(id),
  part INTEGER NOT NULL,
  bytes BLOB NOT NULL,
  UNIQUE(file, part));
CREATE TABLE imported_files(
  name TEXT PRIMARY KEY,
  file INTEGER NOT NULL REFERENCES files(id)) WITHOUT ROWID;
CREATE TABLE texture_sets(
  id INTEGER PRIMARY KEY,
  name TEXT NOT NULL,
  width INTEGER NOT NULL,
  height INTEGER NOT NULL,
  space TEXT NOT NULL,
  green_down INTEGER NOT NULL,
  two_channel INTEGER NOT NULL,
  centred_code INTEGER NOT NULL,
  signed_float INTEGER NOT NULL,
  scale REAL NOT NULL);
CREATE TABLE steps(
  id INTEGER PRIMARY KEY,
  parent INTEGER REFERENCES steps(id),
  next INTEGER REFERENCES steps(id),
  step TEXT NOT NULL,
  target INTEGER NOT NULL,
  details TEXT,
  operator TEXT,
  texels INTEGER NOT NULL,
  recipe BLOB);
CREATE TABLE step_files(
  step INTEGER NOT NULL REFERENCES steps(id),
  name TEXT NOT NULL,
  file INTEGER NOT NULL REFERENCES files(id),
  PRIMARY KEY(step, name)) WITHOUT ROWID;
CREATE TABLE tile_versions(
  id INTEGER PRIMARY KEY,
  step INTEGER REFERENCES steps(id),
  layer INTEGER NOT NULL,
  texture_set INTEGER NOT NULL REFERENCES texture_sets(id),
  attribute TEXT NOT NULL,
  tile INTEGER NOT NULL,
  previous INTEGER REFERENCES tile_versions(id),
  bytes BLOB);
CREATE INDEX tile_versions_by_step ON tile_versions(step);
CREATE TABLE tiles(
  texture_set INTEGER NOT NULL REFERENCES texture_sets(id),
  attribute TEXT NOT NULL,
  tile INTEGER NOT NULL,
  layer INTEGER NOT NULL,
  version INTEGER NOT NULL REFERENCES tile_versions(id),
  PRIMARY KEY(texture_set, attribute, tile, layer)) WITHOUT ROWID;
)";

/// Each makes the next version of the one before; none is ever changed once it is released.
constexpr std::array migrations{first_schema};

constexpr std::size_t header_size = 100;
using Header = std::array<unsigned char, header_size>;

std::uint32_t word(const Header& header, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8U | header[at + i];
  return value;
}

/// The first bytes; all zero where there are fewer.
Header read_header(const fs::path& path) {
  Header header{};
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return header;
  std::ifstream file(path, std::ios::binary);
  if (!file.read(reinterpret_cast<char*>(header.data()), header_size)) return {};
  return header;
}

bool is_document(const Header& header) {
  constexpr std::string_view magic{"SQLite format 3\0", 16};
  return std::equal(magic.begin(), magic.end(), header.begin()) &&
         word(header, 68) == static_cast<std::uint32_t>(document_application_id);
}

std::int64_t version_of(const Database& database) {
  Statement version(database, "PRAGMA user_version");
  return version.step() ? version.integer(0) : 0;
}

/// Who wrote a document of any version, as far as that can be told.
std::string writer_of(const Database& database) {
  try {
    Statement writer(database, "SELECT written_by FROM document");
    if (writer.step())
      return ", written by NormalShop " + std::string(writer.bytes(0).substr(0, 40));
  } catch (const DocumentError&) {
    return {};
  }
  return {};
}

void run_migrations(const Database& database, std::size_t from) {
  Transaction transaction(database);
  for (std::size_t i = from; i < migrations.size(); ++i) database.run(migrations[i]);
  database.run(("PRAGMA user_version = " + std::to_string(migrations.size())).c_str());
  if (from > 0) {
    Statement(database, "UPDATE document SET written_by = ?")
        .bind(1, std::string_view(NORMALSHOP_VERSION))
        .run();
  }
  transaction.commit();
}

}  // namespace

int document_version() { return static_cast<int>(migrations.size()); }

bool is_document_file(const fs::path& path) { return is_document(read_header(path)); }

void check_document_file(const fs::path& path) {
  std::error_code error;
  const auto refuse = [&](const std::string& what) {
    throw DocumentError("'" + path.string() + "' " + what);
  };
  if (!fs::exists(path, error)) refuse("does not exist; \"normalshop new\" makes a document");
  if (::faccessat(AT_FDCWD, path.c_str(), R_OK, AT_EACCESS) != 0)
    refuse("cannot be read: permission denied");
  const Header header = read_header(path);
  if (!is_document(header)) refuse("is no NormalShop document; \"normalshop new\" makes one");
  // The header's count of pages may run ahead of a file whose log is not yet worked in.
  const std::uint32_t stated = word(header, 16) >> 16U;
  const std::uint64_t page = stated == 1 ? 65536 : stated;
  const std::uint64_t whole = page * word(header, 28);
  const std::uintmax_t size = fs::file_size(path, error);
  if (!error && size < whole && !fs::exists(log_of(path), error)) {
    refuse("is truncated: it has " + std::to_string(size) + " bytes of " + std::to_string(whole));
  }
}

void create_schema(const Database& database) {
  database.run(("PRAGMA application_id = " + std::to_string(document_application_id)).c_str());
  run_migrations(database, 0);
}

void migrate(const Database& database) {
  const std::int64_t version = version_of(database);
  const auto known = static_cast<std::int64_t>(migrations.size());
  if (version < 1) database.fail("is damaged: it states no version");
  if (version > known) {
    database.fail("is a document of version " + std::to_string(version) + writer_of(database) +
                  "; this program, NormalShop " NORMALSHOP_VERSION ", opens versions up to " +
                  std::to_string(known) + ": use the newer one");
  }
  if (version == known) return;
  if (database.read_only()) {
    database.fail(
        "is an older document, which is brought up to date when it is opened, but it is "
        "write-protected");
  }
  run_migrations(database, static_cast<std::size_t>(version));
}

}  // namespace normalshop
