#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

/// SQLite in the words that a document needs. Everything here throws DocumentError naming the file.
namespace normalshop {

class Database;

/// A prepared statement: arguments count from 1, columns from 0.
class Statement {
 public:
  Statement(const Database& database, std::string_view sql);

  Statement& bind(int argument, std::int64_t value);
  /// Not copied: it must live until the statement ends or is reset.
  Statement& bind(int argument, std::string_view text);
  Statement& bind_blob(int argument, std::string_view bytes);
  Statement& bind_number(int argument, double value);
  Statement& bind_null(int argument);
  Statement& bind(int argument, const std::optional<std::int64_t>& value) {
    return value ? bind(argument, *value) : bind_null(argument);
  }

  /// The next row; false after the last one.
  bool step();
  /// To the end, and ready for other arguments.
  void run();
  void reset();

  /// Of the present row.
  std::int64_t integer(int column) const;
  double number(int column) const;
  bool is_null(int column) const;
  std::optional<std::int64_t> optional_integer(int column) const;
  /// Text or blob; good until the next step.
  std::string_view bytes(int column) const;

 private:
  struct Finalizer {
    void operator()(sqlite3_stmt* statement) const;
  };
  const Database* database_;
  std::unique_ptr<sqlite3_stmt, Finalizer> statement_;
};

/// One connection, which keeps all other programs out of the file while it lives. Commits are on
/// the disk when they return (write-ahead log, synchronous).
class Database {
 public:
  /// `path` is an empty file, or one that SQLite has written.
  explicit Database(const std::filesystem::path& path);

  const std::filesystem::path& path() const { return path_; }
  /// The file or its folder is write-protected.
  bool read_only() const { return read_only_; }
  /// Statements without results.
  void run(const char* sql) const;
  std::int64_t last_id() const;

  /// What went wrong in the last call, in a sentence that names the file.
  [[noreturn]] void fail() const;
  /// "<path>" what.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  friend class Statement;
  struct Closer {
    void operator()(sqlite3* database) const;
  };
  void configure() const;

  std::filesystem::path path_;
  bool read_only_ = false;
  std::unique_ptr<sqlite3, Closer> handle_;
};

/// All or nothing: without commit() nothing has happened.
class Transaction {
 public:
  explicit Transaction(const Database& database);
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  ~Transaction();
  void commit();

 private:
  const Database& database_;
  bool open_ = true;
};

/// The file beside a document that holds what was committed last.
std::filesystem::path log_of(const std::filesystem::path& document);

}  // namespace normalshop
