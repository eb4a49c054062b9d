#include <sqlite3.h>

#include "lodeline/mapping/store/sqlite/database.h"

namespace lodeline {

Query::~Query() {
  sqlite3_reset(statement_);
  sqlite3_clear_bindings(statement_);
}

void Query::checkBound(int code) {
  if (code != SQLITE_OK) throw database_->error(code);
}

Query& Query::integer(int64_t value) {
  checkBound(sqlite3_bind_int64(statement_, ++parameter_, value));
  return *this;
}

Query& Query::real(double value) {
  checkBound(sqlite3_bind_double(statement_, ++parameter_, value));
  return *this;
}

Query& Query::text(std::string_view value) {
  checkBound(sqlite3_bind_text64(statement_, ++parameter_, value.data() != nullptr ? value.data() : "",
                                 value.size(), SQLITE_TRANSIENT, SQLITE_UTF8));
  return *this;
}

Query& Query::blob(std::span<const unsigned char> value) {
  const unsigned char none = 0;
  checkBound(sqlite3_bind_blob64(statement_, ++parameter_, value.empty() ? &none : value.data(), value.size(),
                                 SQLITE_TRANSIENT));
  return *this;
}

Query& Query::null() {
  checkBound(sqlite3_bind_null(statement_, ++parameter_));
  return *this;
}

Query& Query::realOrNull(const std::optional<double>& value) { return value ? real(*value) : null(); }

Query& Query::integerOrNull(const std::optional<int64_t>& value) { return value ? integer(*value) : null(); }

bool Query::next() {
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) return true;
  if (code == SQLITE_DONE) return false;
  throw database_->error(code);
}

bool Query::isNull(int column) const { return sqlite3_column_type(statement_, column) == SQLITE_NULL; }
int64_t Query::integerAt(int column) const { return sqlite3_column_int64(statement_, column); }
double Query::realAt(int column) const { return sqlite3_column_double(statement_, column); }

std::string Query::textAt(int column) const {
  const auto* text = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
  return text != nullptr ? std::string(text, static_cast<size_t>(sqlite3_column_bytes(statement_, column)))
                         : std::string();
}

std::span<const unsigned char> Query::blobAt(int column) const {
  const auto* bytes = static_cast<const unsigned char*>(sqlite3_column_blob(statement_, column));
  return {bytes, bytes != nullptr ? static_cast<size_t>(sqlite3_column_bytes(statement_, column)) : 0};
}

}  // namespace lodeline
