#include "lodeline/io/rosbag/convert/database_writer.h"

#include <fmt/core.h>
#include <sqlite3.h>

#include <fstream>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

constexpr const char* kSchema = R"(
PRAGMA journal_mode = OFF;
PRAGMA synchronous = OFF;
CREATE TABLE schema(schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);
CREATE TABLE metadata(id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, metadata TEXT NOT NULL);
CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
  serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL, type_description_hash TEXT NOT NULL);
CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT NOT NULL,
  encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL);
CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,
  data BLOB NOT NULL);
INSERT INTO schema VALUES(4, 'iron');
BEGIN;
)";
constexpr int kMessagesAtOnce = 1000;

void bindText(sqlite3_stmt* statement, int place, const std::string& text) {
  sqlite3_bind_text(statement, place, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT);
}

}  // namespace

void DatabaseWriter::Closer::operator()(sqlite3* database) const { sqlite3_close_v2(database); }

void DatabaseWriter::Closer::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

DatabaseWriter::DatabaseWriter(const std::filesystem::path& file, std::filesystem::path metadata)
    : file_(file), metadata_(std::move(metadata)) {
  sqlite3* opened = nullptr;
  const int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
  const int result = sqlite3_open_v2(file.c_str(), &opened, flags, nullptr);
  database_.reset(opened);
  if (result != SQLITE_OK) refuse();
  execute(kSchema);
  insert_ = prepare("INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)");
}

void DatabaseWriter::refuse() const {
  throw InputError(fmt::format("{}: cannot be written ({}); is there space and permission?", file_.string(),
                               database_ ? sqlite3_errmsg(database_.get()) : "no memory"));
}

void DatabaseWriter::execute(const char* sql) {
  if (sqlite3_exec(database_.get(), sql, nullptr, nullptr, nullptr) != SQLITE_OK) refuse();
}

DatabaseWriter::Statement DatabaseWriter::prepare(const char* sql) {
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v2(database_.get(), sql, -1, &statement, nullptr) != SQLITE_OK) refuse();
  return Statement(statement);
}

void DatabaseWriter::run(sqlite3_stmt* statement) {
  if (sqlite3_step(statement) != SQLITE_DONE) refuse();
  sqlite3_reset(statement);
}

void DatabaseWriter::write(const std::string& topic, const std::string& type, Time received,
                           wire::Bytes message) {
  const auto [written, is_new] = messages_.topic(topic, type, "", received);
  add(*written, is_new, received, messages_.toCdr(type, message));
}

void DatabaseWriter::writeStored(const BagConnection& connection, Time received, wire::Bytes message) {
  const auto [written, is_new] =
      messages_.topic(connection.topic, connection.type, connection.definition, received);
  add(*written, is_new, received, message);
}

void DatabaseWriter::add(const WrittenTopic& topic, bool is_new, Time received, const wire::Bytes& message) {
  if (is_new) addTopic(topic);
  sqlite3_bind_int(insert_.get(), 1, topic.number);
  sqlite3_bind_int64(insert_.get(), 2, received.nanoseconds());
  sqlite3_bind_blob64(insert_.get(), 3, message.data(), message.size(), SQLITE_STATIC);
  run(insert_.get());
  if (++uncommitted_ < kMessagesAtOnce) return;
  execute("COMMIT; BEGIN;");
  uncommitted_ = 0;
}

void DatabaseWriter::addTopic(const WrittenTopic& topic) {
  const Statement row = prepare("INSERT INTO topics VALUES(?, ?, ?, 'cdr', '', '')");
  sqlite3_bind_int(row.get(), 1, topic.number);
  bindText(row.get(), 2, topic.name);
  bindText(row.get(), 3, topic.type);
  run(row.get());
  const Statement definition = prepare(
      "INSERT INTO message_definitions(topic_type, encoding, encoded_message_definition, "
      "type_description_hash) SELECT ?1, 'ros2msg', ?2, '' WHERE NOT EXISTS (SELECT 1 FROM "
      "message_definitions WHERE topic_type = ?1)");
  bindText(definition.get(), 1, topic.type);
  bindText(definition.get(), 2, topic.definition);
  run(definition.get());
}

void DatabaseWriter::close() {
  const std::string text = metadataText(messages_, file_.filename().string(), "sqlite3");
  {
    const Statement metadata = prepare("INSERT INTO metadata(metadata_version, metadata) VALUES(5, ?)");
    bindText(metadata.get(), 1, text);
    run(metadata.get());
  }
  execute("COMMIT; CREATE INDEX timestamp_idx ON messages (timestamp ASC);");
  insert_.reset();
  database_.reset();
  if (metadata_.empty()) return;
  std::ofstream stream(metadata_);
  stream << text;
  stream.close();
  if (!stream) throw InputError(metadata_.string() + ": could not be written");
}

}  // namespace lodeline
