#include "normalshop/document/store/database.h"

#include <array>
#include <system_error>

#include <fcntl.h>
#include <sqlite3.h>
#include <unistd.h>

#include "normalshop/core/error.h"

namespace normalshop {

namespace {

namespace fs = std::filesystem;

constexpr int wait_ms = 500;                 // for a program that is just closing the file
constexpr int longest_value = 64 << 20;      // no part of a document is larger
constexpr int longest_statement = 64 << 10;  // ours are short

fs::path folder_of_file(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

/// As SQLite's URIs want it; says that nobody changes the file, so that nothing is written beside
/// it.
std::string immutable_uri(const fs::path& path) {
  static constexpr std::string_view digits = "0123456789ABCDEF";
  std::string uri = "file:";
  for (const char c : path.string()) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '%' || c == '?' || c == '#') {
      uri += '%';
      uri += digits[byte / 16U];
      uri += digits[byte % 16U];
    } else {
      uri += c;
    }
  }
  return uri + "?immutable=1";
}

/// To the user whom the program acts for.
bool allows(const fs::path& path, int access) {
  return ::faccessat(AT_FDCWD, path.c_str(), access, AT_EACCESS) == 0;
}

bool holds_bytes(const fs::path& path) {
  std::error_code error;
  const std::uintmax_t size = fs::file_size(path, error);
  return !error && size > 0;
}

std::string_view blob_or_text(sqlite3_stmt* statement, int column) {
  const void* data = sqlite3_column_blob(statement, column);
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement, column));
  return data == nullptr ? std::string_view()
                         : std::string_view(static_cast<const char*>(data), size);
}

}  // namespace

fs::path log_of(const fs::path& document) {
  fs::path log = document;
  log += "-wal";
  return log;
}

void Statement::Finalizer::operator()(sqlite3_stmt* statement) const {
  sqlite3_finalize(statement);
}

Statement::Statement(const Database& database, std::string_view sql) : database_(&database) {
  sqlite3_stmt* statement = nullptr;
  const int code = sqlite3_prepare_v2(database.handle_.get(), sql.data(),
                                      static_cast<int>(sql.size()), &statement, nullptr);
  statement_.reset(statement);
  if (code != SQLITE_OK) database.fail();
}

Statement& Statement::bind(int argument, std::int64_t value) {
  if (sqlite3_bind_int64(statement_.get(), argument, value) != SQLITE_OK) database_->fail();
  return *this;
}

Statement& Statement::bind(int argument, std::string_view text) {
  if (sqlite3_bind_text64(statement_.get(), argument, text.data(), text.size(), SQLITE_STATIC,
                          SQLITE_UTF8) != SQLITE_OK) {
    database_->fail();
  }
  return *this;
}

Statement& Statement::bind_blob(int argument, std::string_view bytes) {
  // A null pointer would be bound as NULL.
  const char* data = bytes.empty() ? "" : bytes.data();
  if (sqlite3_bind_blob64(statement_.get(), argument, data, bytes.size(), SQLITE_STATIC) !=
      SQLITE_OK) {
    database_->fail();
  }
  return *this;
}

Statement& Statement::bind_number(int argument, double value) {
  if (sqlite3_bind_double(statement_.get(), argument, value) != SQLITE_OK) database_->fail();
  return *this;
}

Statement& Statement::bind_null(int argument) {
  if (sqlite3_bind_null(statement_.get(), argument) != SQLITE_OK) database_->fail();
  return *this;
}

bool Statement::step() {
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_ROW) return true;
  if (code != SQLITE_DONE) database_->fail();
  return false;
}

void Statement::run() {
  while (step()) {
  }
  reset();
}

void Statement::reset() { sqlite3_reset(statement_.get()); }

std::int64_t Statement::integer(int column) const {
  return sqlite3_column_int64(statement_.get(), column);
}

double Statement::number(int column) const {
  return sqlite3_column_double(statement_.get(), column);
}

bool Statement::is_null(int column) const {
  return sqlite3_column_type(statement_.get(), column) == SQLITE_NULL;
}

std::optional<std::int64_t> Statement::optional_integer(int column) const {
  if (is_null(column)) return std::nullopt;
  return integer(column);
}

std::string_view Statement::bytes(int column) const {
  return blob_or_text(statement_.get(), column);
}

void Database::Closer::operator()(sqlite3* database) const { sqlite3_close_v2(database); }

Database::Database(const fs::path& path) : path_(path) {
  read_only_ = !allows(path, W_OK) || !allows(folder_of_file(path), W_OK | X_OK);
  if (read_only_ && holds_bytes(log_of(path))) {
    fail(
        "is write-protected, and the program that had it open last did not close it; allow "
        "writing to it and its folder once");
  }
  const fs::path whole = fs::absolute(path);
  const std::string name = read_only_ ? immutable_uri(whole) : whole.string();
  const int flags = (read_only_ ? SQLITE_OPEN_READONLY | SQLITE_OPEN_URI : SQLITE_OPEN_READWRITE) |
                    SQLITE_OPEN_EXRESCODE;
  sqlite3* handle = nullptr;
  const int code = sqlite3_open_v2(name.c_str(), &handle, flags, nullptr);
  handle_.reset(handle);
  if (handle == nullptr) throw std::bad_alloc();
  if (code != SQLITE_OK) fail();
  configure();
}

/// What comes in the file is not trusted to run anything.
void Database::configure() const {
  sqlite3* db = handle_.get();
  sqlite3_busy_timeout(db, wait_ms);
  sqlite3_limit(db, SQLITE_LIMIT_LENGTH, longest_value);
  sqlite3_limit(db, SQLITE_LIMIT_SQL_LENGTH, longest_statement);
  sqlite3_limit(db, SQLITE_LIMIT_ATTACHED, 0);
  sqlite3_limit(db, SQLITE_LIMIT_TRIGGER_DEPTH, 1);
  for (const auto& [option, value] : {std::pair{SQLITE_DBCONFIG_DEFENSIVE, 1},
                                      {SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0},
                                      {SQLITE_DBCONFIG_ENABLE_TRIGGER, 0},
                                      {SQLITE_DBCONFIG_ENABLE_VIEW, 0},
                                      {SQLITE_DBCONFIG_ENABLE_FKEY, 1}}) {
    sqlite3_db_config(db, option, value, nullptr);
  }
  run("PRAGMA cell_size_check = ON");
  if (read_only_) return;
  // Before the first access: the log then needs no memory that is shared with others.
  run("PRAGMA locking_mode = EXCLUSIVE");
  run("PRAGMA journal_mode = WAL");
  run("PRAGMA synchronous = FULL");
}

void Database::run(const char* sql) const {
  if (sqlite3_exec(handle_.get(), sql, nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

std::int64_t Database::last_id() const { return sqlite3_last_insert_rowid(handle_.get()); }

void Database::fail(const std::string& what) const {
  throw DocumentError("'" + path_.string() + "' " + what);
}

void Database::fail() const {
  sqlite3* db = handle_.get();
  const int code = sqlite3_extended_errcode(db);
  const int system = sqlite3_system_errno(db);
  switch (code & 0xFF) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      fail("is open in another program; close it there first");
    case SQLITE_NOTADB:
    case SQLITE_CORRUPT:
      fail("is damaged (" + std::string(sqlite3_errmsg(db)) + ")");
    case SQLITE_FULL:
      fail("cannot be written: the disk is full");
    case SQLITE_READONLY:
      fail("is write-protected");
    case SQLITE_NOMEM:
      throw std::bad_alloc();
    default:
      break;
  }
  std::string what = sqlite3_errmsg(db);
  if (system != 0) what += ", " + std::generic_category().message(system);
  fail("cannot be read or written: " + what);
}

Transaction::Transaction(const Database& database) : database_(database) {
  database.run("BEGIN IMMEDIATE");
}

Transaction::~Transaction() {
  if (!open_) return;
  try {
    database_.run("ROLLBACK");
  } catch (const std::exception&) {
    // After some errors SQLite has rolled back already.
    open_ = false;
  }
}

void Transaction::commit() {
  database_.run("COMMIT");
  open_ = false;
}

}  // namespace normalshop
