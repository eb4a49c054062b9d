#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "lodeline/diagnostics.h"

struct sqlite3;
struct sqlite3_stmt;

namespace lodeline {

class Database;

/// One use of a prepared SQL statement: bind values, step through rows, read columns. Destruction resets the
/// statement, so that it can be used again.
class Query {
 public:
  Query(Database* database, sqlite3_stmt* statement) : database_(database), statement_(statement) {}
  Query(const Query&) = delete;
  Query& operator=(const Query&) = delete;
  ~Query();

  /// Binds the next parameters from left to right.
  Query& integer(int64_t value);
  Query& real(double value);
  Query& text(std::string_view value);
  Query& blob(std::span<const unsigned char> value);
  Query& null();
  Query& realOrNull(const std::optional<double>& value);
  Query& integerOrNull(const std::optional<int64_t>& value);

  bool next();  ///< moves to the next row; false after the last one
  void run() {
    while (next()) {
    }
  }

  bool isNull(int column) const;
  int64_t integerAt(int column) const;
  double realAt(int column) const;
  std::string textAt(int column) const;
  /// Valid until the next call of next().
  std::span<const unsigned char> blobAt(int column) const;

 private:
  void checkBound(int code);

  Database* database_;
  sqlite3_stmt* statement_;
  int parameter_ = 0;
};

/// An SQLite database file. Errors of the library become an InputError that names the file and the remedy.
/// Prepared statements are kept and used again.
class Database {
 public:
  enum class Mode { Read, Change, Create };

  /// Waits up to 5 s where another program holds the file. Reading too completes or undoes what a program
  /// that was killed left behind, where permissions allow it.
  Database(const std::filesystem::path& file, Mode mode);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  /// Runs statements without parameters.
  void run(const char* sql);
  /// The same on tables that only this object has, also where the file can only be read.
  void runOnTemporaryTables(const char* sql);
  Query query(std::string_view sql);
  /// First column of the first row, an integer.
  int64_t number(std::string_view sql);

  int64_t lastRow() const;  ///< row id of the last insertion
  int changedRows() const;  ///< by the last statement
  bool inTransaction() const;
  bool isReadOnly() const { return is_read_only_; }
  const std::filesystem::path& path() const { return path_; }

  /// The error of the library's result `code` in words.
  InputError error(int code) const;

 private:
  void open(const std::string& name, int flags);

  std::filesystem::path path_;
  bool is_read_only_ = false;
  sqlite3* handle_ = nullptr;
  std::map<std::string, sqlite3_stmt*, std::less<>> statements_;
};

}  // namespace lodeline
