#include "lodeline/io/rosbag/ros2/bag_database.h"

#include <fmt/core.h>
#include <sqlite3.h>

#include <limits>

#include "lodeline/io/rosbag/definitions/definition_parser.h"

namespace lodeline {
namespace {

constexpr int64_t kMostTopics = 1 << 16;

std::string textOf(sqlite3_stmt* statement, int column) {
  const auto* first = reinterpret_cast<const char*>(sqlite3_column_text(statement, column));
  if (first == nullptr) return {};
  return {first, static_cast<size_t>(sqlite3_column_bytes(statement, column))};
}

/// The file as a URI, with the characters escaped that mean something there.
std::string uriOf(const std::filesystem::path& file, const char* mode) {
  std::string uri = "file:";
  for (const char c : std::filesystem::absolute(file).string()) {
    uri += c == '%' || c == '?' || c == '#' ? fmt::format("%{:02X}", c) : std::string(1, c);
  }
  return fmt::format("{}?{}", uri, mode);
}

}  // namespace

void BagDatabase::Closer::operator()(sqlite3* database) const { sqlite3_close_v2(database); }

void BagDatabase::Closer::operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }

BagDatabase::BagDatabase(const std::filesystem::path& file, std::string name, Diagnostics* diagnostics)
    : name_(std::move(name)), diagnostics_(diagnostics) {
  open(file);
  if (!hasTable("topics") || !hasTable("messages")) {
    throw InputError(fmt::format("{}: is a SQLite database, but no ROS 2 bag: it {}", name_,
                                 sqlite3_errcode(database_.get()) == SQLITE_DONE
                                     ? "has no tables topics and messages"
                                     : sqlite3_errmsg(database_.get())));
  }
  reading_ = prepare("SELECT data FROM messages WHERE rowid = ?");
  if (reading_ == nullptr) {
    throw InputError(fmt::format("{}: its table of messages is not that of a ROS 2 bag ({})", name_,
                                 sqlite3_errmsg(database_.get())));
  }
}

void BagDatabase::open(const std::filesystem::path& file) {
  // Without a write-ahead log nothing beside the file is needed, not even permission to write there.
  std::error_code ignored;
  const bool has_log = std::filesystem::exists(file.string() + "-wal", ignored);
  for (const char* mode : {has_log ? "mode=ro" : "immutable=1", "immutable=1"}) {
    sqlite3* opened = nullptr;
    const int result = sqlite3_open_v2(uriOf(file, mode).c_str(), &opened,
                                       SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX, nullptr);
    database_.reset(opened);
    if (result != SQLITE_OK) continue;
    sqlite3_db_config(opened, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(opened, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    const Statement probe = prepare("SELECT count(*) FROM sqlite_master");
    if (probe != nullptr && sqlite3_step(probe.get()) == SQLITE_ROW) return;
  }
  throw InputError(fmt::format("{}: cannot be opened as a SQLite database: {}", name_,
                               database_ ? sqlite3_errmsg(database_.get()) : "no memory"));
}

bool BagDatabase::hasTable(const char* table) {
  const Statement statement =
      prepare("SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = ? AND sql LIKE 'CREATE TABLE%'");
  if (statement == nullptr) return false;
  sqlite3_bind_text(statement.get(), 1, table, -1, SQLITE_STATIC);
  return sqlite3_step(statement.get()) == SQLITE_ROW;
}

BagDatabase::Statement BagDatabase::prepare(const char* sql) {
  sqlite3_stmt* statement = nullptr;
  if (sqlite3_prepare_v2(database_.get(), sql, -1, &statement, nullptr) != SQLITE_OK) return nullptr;
  return Statement(statement);
}

bool BagDatabase::step(sqlite3_stmt* statement) {
  if (statement == nullptr) return false;
  const int result = sqlite3_step(statement);
  if (result == SQLITE_ROW) return true;
  if (result != SQLITE_DONE) {
    diagnostics_->report(Severity::Warning, "bag_damaged",
                         fmt::format("{}: is damaged or was cut off ({}); what lies behind is lost", name_,
                                     sqlite3_errmsg(database_.get())));
  }
  return false;
}

void BagDatabase::scan(uint32_t number, uint32_t first_topic, BagContents* contents) {
  scanTopics(first_topic, contents);
  scanMessages(number, first_topic, contents);
}

void BagDatabase::scanTopics(uint32_t first_topic, BagContents* contents) {
  const Statement topics = prepare("SELECT id, name, type, serialization_format FROM topics");
  while (step(topics.get())) {
    const int64_t id = sqlite3_column_int64(topics.get(), 0);
    if (id < 0 || id >= kMostTopics) continue;
    BagConnection connection;
    connection.topic = textOf(topics.get(), 1);
    connection.type = definitions::shortTypeName(textOf(topics.get(), 2));
    const std::string format = textOf(topics.get(), 3);
    connection.serialization.reset();
    if (format == "cdr") {
      connection.serialization = definitions::Serialization::Cdr;
    } else {
      connection.problem = fmt::format("the serialization format '{}' of its messages is not read", format);
    }
    contents->connections[first_topic + static_cast<uint32_t>(id)] = std::move(connection);
  }
  if (!hasTable("message_definitions")) return;
  std::map<std::string, std::string> by_type;
  const Statement definitions =
      prepare("SELECT topic_type, encoding, encoded_message_definition FROM message_definitions");
  while (step(definitions.get())) {
    if (textOf(definitions.get(), 1) != "ros2msg") continue;
    by_type[definitions::shortTypeName(textOf(definitions.get(), 0))] = textOf(definitions.get(), 2);
  }
  for (auto& [id, connection] : contents->connections) {
    if (id < first_topic) continue;
    // The definition of a service is stored under the name of the service.
    std::string type = connection.type;
    constexpr std::string_view kEvent = "_Event";
    if (!by_type.contains(type) && type.ends_with(kEvent)) type.resize(type.size() - kEvent.size());
    const auto definition = by_type.find(type);
    if (definition != by_type.end()) connection.definition = definition->second;
  }
}

void BagDatabase::scanMessages(uint32_t number, uint32_t first_topic, BagContents* contents) {
  const Statement messages = prepare("SELECT rowid, topic_id, timestamp FROM messages ORDER BY rowid");
  int64_t unusable = 0;
  while (step(messages.get())) {
    const int64_t row = sqlite3_column_int64(messages.get(), 0);
    const int64_t topic = sqlite3_column_int64(messages.get(), 1);
    const bool is_usable = row >= 0 && row <= std::numeric_limits<uint32_t>::max() && topic >= 0 &&
                           topic < kMostTopics &&
                           contents->connections.contains(first_topic + static_cast<uint32_t>(topic));
    if (!is_usable) {
      ++unusable;
      continue;
    }
    const Time received = Time::fromNanoseconds(sqlite3_column_int64(messages.get(), 2));
    contents->entries[first_topic + static_cast<uint32_t>(topic)].push_back(
        {received, number, static_cast<uint32_t>(row)});
  }
  if (unusable > 0) {
    diagnostics_->report(
        Severity::Warning, "bag_damaged",
        fmt::format("{}: {} messages belong to no topic; they are passed over", name_, unusable));
  }
}

std::optional<wire::Bytes> BagDatabase::read(uint32_t row) {
  sqlite3_reset(reading_.get());
  sqlite3_bind_int64(reading_.get(), 1, row);
  if (sqlite3_step(reading_.get()) != SQLITE_ROW) return std::nullopt;
  const auto* first = static_cast<const uint8_t*>(sqlite3_column_blob(reading_.get(), 0));
  const int size = sqlite3_column_bytes(reading_.get(), 0);
  if (first == nullptr || size <= 0) return std::nullopt;
  return wire::Bytes(first, first + size);
}

}  // namespace lodeline
