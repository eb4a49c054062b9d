#pragma once

#include <filesystem>

#include "lodeline/io/logs/readings/sensor_log.h"

namespace lodeline {

/// A single table (PlainCsv) as a sensor log.
class TableLog : public SensorLog {
 public:
  /// Throws InputError as PlainCsv does; `diagnostics` must outlive the log.
  TableLog(const std::filesystem::path& file, const PlainCsvOptions& options, Diagnostics* diagnostics);

  bool next(LogReading* reading) override;

 private:
  PlainCsv csv_;
};

}  // namespace lodeline
