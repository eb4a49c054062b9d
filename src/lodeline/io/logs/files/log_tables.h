#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/io/csv/plain_csv.h"

namespace lodeline {

/// A file with a table in a folder or a zip archive.
struct LogTable {
  std::string name;  ///< of the file, without its folder
  std::function<std::unique_ptr<ByteSource>()> open;
};

/// The tables (.csv, .tsv, .txt) directly in a folder, or anywhere in a zip archive, in the order of their
/// names. Throws InputError where the archive is damaged.
std::vector<LogTable> tablesIn(const std::filesystem::path& path);

/// What is known of a recording of telephone programs beside its readings.
struct RecordingFacts {
  bool is_sensor_logger = false;
  bool has_metadata = false;
  /// Whether accelerations point the other way, as on an iPhone: -9.8 upwards at rest.
  bool has_negative_forces = false;
};
RecordingFacts factsOf(const std::vector<LogTable>& tables);

/// The tables of a recording from which each sensor is taken.
struct TableChoice {
  std::optional<size_t> gyroscope, accelerometer, magnetometer;
  /// Gravity, to be added to accelerations without it.
  std::optional<size_t> gravity;
  bool has_no_gravity = false;  ///< there are accelerations, but none with gravity
  bool isEmpty() const { return !gyroscope && !accelerometer && !magnetometer; }
};

/// Selects the tables by their columns, or by their names where the columns are only x, y and z. Readings
/// that the telephone did not correct ("Uncalibrated") are preferred. An acceleration includes gravity if its
/// median magnitude says so. Tables of watches and headphones are left out.
TableChoice chooseTables(const std::vector<LogTable>& tables);

/// Options to read a table of a recording.
PlainCsvOptions tableOptions(const LogTable& table, const RecordingFacts& facts);

}  // namespace lodeline
