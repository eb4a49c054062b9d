#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag/container/bag_file.h"

struct sqlite3;
struct sqlite3_stmt;

namespace lodeline {

/// The SQLite database of a ROS 2 bag (.db3), opened for reading. All versions of its schema have the tables
/// `topics` and `messages`; since version 4, `message_definitions` holds the definitions.
class BagDatabase {
 public:
  /// `file`: the database. `name`: for messages. Throws InputError where it is no database of a bag.
  BagDatabase(const std::filesystem::path& file, std::string name, Diagnostics* diagnostics);

  /// Adds the topics, with numbers from `first_topic` on, and the messages with `number` as their chunk.
  /// Reports a damaged database as `bag_damaged`, and gives what could be read.
  void scan(uint32_t number, uint32_t first_topic, BagContents* contents);

  /// The bytes of a message; nothing where the database is damaged there.
  std::optional<wire::Bytes> read(uint32_t row);

 private:
  struct Closer {
    void operator()(sqlite3* database) const;
    void operator()(sqlite3_stmt* statement) const;
  };
  using Statement = std::unique_ptr<sqlite3_stmt, Closer>;

  void open(const std::filesystem::path& file);
  bool hasTable(const char* table);
  Statement prepare(const char* sql);
  /// Goes to the next row; reports damage.
  bool step(sqlite3_stmt* statement);
  void scanTopics(uint32_t first_topic, BagContents* contents);
  void scanMessages(uint32_t number, uint32_t first_topic, BagContents* contents);

  std::string name_;
  Diagnostics* diagnostics_;
  std::unique_ptr<sqlite3, Closer> database_;
  Statement reading_;
};

}  // namespace lodeline
