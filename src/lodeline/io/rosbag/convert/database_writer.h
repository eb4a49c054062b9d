#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "lodeline/io/rosbag/convert/bag_writer.h"
#include "lodeline/io/rosbag/convert/ros2_messages.h"

struct sqlite3;
struct sqlite3_stmt;

namespace lodeline {

/// Writes a bag of ROS 2 as a SQLite database with version 4 of rosbag2's schema, which contains the
/// definitions of the messages.
class DatabaseWriter : public BagWriter {
 public:
  /// `metadata`: file to write at the end; empty for none. Throws InputError where the file cannot be
  /// written.
  DatabaseWriter(const std::filesystem::path& file, std::filesystem::path metadata);

  void write(const std::string& topic, const std::string& type, Time received, wire::Bytes message) override;
  bool takesStored(const BagConnection& connection) const override { return isStoredRos2(connection); }
  void writeStored(const BagConnection& connection, Time received, wire::Bytes message) override;
  void close() override;

 private:
  struct Closer {
    void operator()(sqlite3* database) const;
    void operator()(sqlite3_stmt* statement) const;
  };
  using Statement = std::unique_ptr<sqlite3_stmt, Closer>;

  void execute(const char* sql);
  Statement prepare(const char* sql);
  void run(sqlite3_stmt* statement);
  void add(const WrittenTopic& topic, bool is_new, Time received, const wire::Bytes& message);
  void addTopic(const WrittenTopic& topic);
  [[noreturn]] void refuse() const;

  std::filesystem::path file_, metadata_;
  std::unique_ptr<sqlite3, Closer> database_;
  Statement insert_;
  Ros2Messages messages_;
  int uncommitted_ = 0;
};

}  // namespace lodeline
