#include "lodeline/io/logs/files/table_log.h"

namespace lodeline {

TableLog::TableLog(const std::filesystem::path& file, const PlainCsvOptions& options,
                   Diagnostics* diagnostics)
    : csv_(file, diagnostics, options) {
  sensors_.has_gyroscope = csv_.hasGyroscope();
  sensors_.has_accelerometer = csv_.hasAccelerometer();
  sensors_.has_magnetometer = csv_.hasMagnetometer();
  sensors_.has_whole_imu = sensors_.has_gyroscope && sensors_.has_accelerometer;
  sensors_.has_times = csv_.hasTimes();
  sensors_.states_field_unit = csv_.statesFieldUnit();
  sensors_.has_relative_field = csv_.hasRelativeField();
}

bool TableLog::next(LogReading* reading) {
  *reading = {};
  return csv_.next(reading);
}

}  // namespace lodeline
