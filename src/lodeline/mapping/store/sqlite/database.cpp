#include "lodeline/mapping/store/sqlite/database.h"

#include <fmt/format.h>
#include <sqlite3.h>
#include <unistd.h>

#include <cstring>

namespace lodeline {
namespace {

constexpr int kWait_ms = 5000;

/// A path as URI, which the library takes apart at '?', '#' and '%'.
std::string uriOf(const std::filesystem::path& path, const char* options) {
  std::string uri = "file:";
  for (const char c : std::filesystem::absolute(path).string()) {
    if (c == '?' || c == '#' || c == '%')
      uri += fmt::format("%{:02X}", static_cast<unsigned char>(c));
    else
      uri += c;
  }
  return uri + options;
}

std::filesystem::path beside(const std::filesystem::path& path, const char* suffix) {
  return path.string() + suffix;
}

bool isWritable(const std::filesystem::path& path) { return access(path.c_str(), W_OK) == 0; }

std::filesystem::path folderOf(const std::filesystem::path& path) {
  return std::filesystem::absolute(path).parent_path();
}

}  // namespace

Database::Database(const std::filesystem::path& file, Mode mode) : path_(file) {
  if (mode != Mode::Create && !std::filesystem::exists(file))
    throw InputError(fmt::format("{}: there is no such file", file.string()));
  if (std::filesystem::is_directory(file))
    throw InputError(fmt::format("{}: is a folder, not a file", file.string()));
  if (mode == Mode::Change && !isWritable(file))
    throw InputError(fmt::format("{}: cannot be changed, for lack of write permission", file.string()));
  is_read_only_ = mode == Mode::Read;
  if (!is_read_only_) {
    open(uriOf(file, ""), SQLITE_OPEN_READWRITE | (mode == Mode::Create ? SQLITE_OPEN_CREATE : 0));
  } else if (isWritable(file) && isWritable(folderOf(file))) {
    open(uriOf(file, ""), SQLITE_OPEN_READWRITE);
    run("PRAGMA query_only = ON");
  } else {
    // In a folder without write permission, the library cannot make its index of the write-ahead log.
    const bool has_log = std::filesystem::exists(beside(file, "-wal"));
    open(uriOf(file, has_log ? "" : "?immutable=1"), SQLITE_OPEN_READONLY);
  }
}

void Database::open(const std::string& name, int flags) {
  const int code =
      sqlite3_open_v2(name.c_str(), &handle_, flags | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX, nullptr);
  if (code != SQLITE_OK) {
    const InputError failure = error(code);
    sqlite3_close_v2(handle_);
    throw failure;
  }
  sqlite3_extended_result_codes(handle_, 1);
  sqlite3_busy_timeout(handle_, kWait_ms);
  // A damaged or hostile file must not make the library run its schema's functions.
  sqlite3_db_config(handle_, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(handle_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
}

Database::~Database() {
  for (auto& [sql, statement] : statements_) sqlite3_finalize(statement);
  sqlite3_close_v2(handle_);
}

void Database::run(const char* sql) {
  const int code = sqlite3_exec(handle_, sql, nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) throw error(code);
}

void Database::runOnTemporaryTables(const char* sql) {
  if (is_read_only_) run("PRAGMA query_only = OFF");
  run(sql);
  if (is_read_only_) run("PRAGMA query_only = ON");
}

Query Database::query(std::string_view sql) {
  auto found = statements_.find(sql);
  if (found == statements_.end()) {
    sqlite3_stmt* statement = nullptr;
    const int code = sqlite3_prepare_v3(handle_, sql.data(), static_cast<int>(sql.size()),
                                        SQLITE_PREPARE_PERSISTENT, &statement, nullptr);
    if (code != SQLITE_OK) throw error(code);
    found = statements_.emplace(std::string(sql), statement).first;
  }
  return Query(this, found->second);
}

int64_t Database::number(std::string_view sql) {
  Query query = this->query(sql);
  return query.next() ? query.integerAt(0) : 0;
}

int64_t Database::lastRow() const { return sqlite3_last_insert_rowid(handle_); }
int Database::changedRows() const { return sqlite3_changes(handle_); }
bool Database::inTransaction() const { return sqlite3_get_autocommit(handle_) == 0; }

InputError Database::error(int code) const {
  const char* said = handle_ != nullptr ? sqlite3_errmsg(handle_) : sqlite3_errstr(code);
  const int system_error = handle_ != nullptr ? sqlite3_system_errno(handle_) : 0;
  const auto words = [&]() -> std::string {
    switch (code & 0xff) {
      case SQLITE_NOTADB:
        return "is no map (no SQLite file)";
      case SQLITE_CORRUPT:
        return fmt::format("is damaged ({}); restore a copy of the map", said);
      case SQLITE_BUSY:
      case SQLITE_LOCKED:
        return "another program is changing this map; wait until it ends";
      case SQLITE_READONLY:
        return "cannot be changed; check the permissions of the file and its folder";
      case SQLITE_CANTOPEN:
        return fmt::format("cannot be opened ({}); check the permissions of the file and its folder",
                           system_error != 0 ? std::strerror(system_error) : said);
      case SQLITE_FULL:
        return "writing failed because the disk is full; the map is as before this change";
      case SQLITE_IOERR:
        return fmt::format("reading or writing failed ({}); is the disk full?",
                           system_error != 0 ? std::strerror(system_error) : said);
      case SQLITE_CONSTRAINT:
        return fmt::format("does not take this row ({})", said);
      case SQLITE_NOMEM:
        return "there is too little memory";
      default:
        return fmt::format("cannot be used as a map ({})", said);
    }
  };
  return InputError(fmt::format("{}: {}", path_.string(), words()));
}

}  // namespace lodeline
