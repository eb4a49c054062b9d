#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "lodeline/io/logs/files/log_tables.h"
#include "lodeline/io/logs/readings/sensor_log.h"

namespace lodeline {

/// A recording whose sensors are in separate tables of a folder or a zip archive, as phyphox and Sensor
/// Logger write them. The readings of all tables are merged in the order of their times.
class FolderLog : public SensorLog {
 public:
  /// Throws InputError where no table holds readings of a sensor. `diagnostics` must outlive the log.
  FolderLog(const std::filesystem::path& path, Diagnostics* diagnostics);
  ~FolderLog() override;

  bool next(LogReading* reading) override;

 private:
  class Stream;

  void addStream(const std::vector<LogTable>& tables, size_t table, const RecordingFacts& facts);
  void reportContent(const std::filesystem::path& path, const std::vector<LogTable>& tables,
                     const TableChoice& choice, const RecordingFacts& facts) const;

  Diagnostics* diagnostics_;
  TableChoice choice_;
  std::vector<std::unique_ptr<Stream>> streams_;
};

}  // namespace lodeline
