#include "lodeline/io/logs/files/folder_log.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <optional>
#include <set>

#include "lodeline/diagnostics.h"
#include "lodeline/io/streams/imu_halves.h"

namespace lodeline {

/// The readings of one table, of the sensors for which it was chosen.
class FolderLog::Stream {
 public:
  Stream(const LogTable& table, const PlainCsvOptions& options, Diagnostics* diagnostics)
      : csv_(table.open(), table.name, diagnostics, options) {}

  bool takes_gyroscope = false, takes_accelerometer = false, takes_magnetometer = false;
  double force_factor = 1.0;
  std::unique_ptr<Stream> gravity;  ///< to be added to the accelerations

  const PlainCsv& csv() const { return csv_; }

  /// The next reading without taking it; empty at the end.
  const std::optional<LogReading>& peek() {
    if (!is_read_) ahead_ = read();
    is_read_ = true;
    return ahead_;
  }
  LogReading take() {
    is_read_ = false;
    return *ahead_;
  }

 private:
  std::optional<LogReading> readRow() {
    LogReading reading;
    if (!csv_.next(&reading)) return std::nullopt;
    if (!takes_gyroscope) reading.angular_velocity.reset();
    if (!takes_accelerometer) reading.specific_force.reset();
    if (!takes_magnetometer) reading.field.reset();
    if (reading.specific_force) *reading.specific_force *= force_factor;
    return reading;
  }

  std::optional<LogReading> read() {
    if (gravity == nullptr) return readRow();
    // The sum, with gravity interpolated at the times of the accelerations.
    const auto half = [](Stream* stream) -> std::optional<ImuSample> {
      const std::optional<LogReading> row = stream->readRow();
      if (!row) return std::nullopt;
      return ImuSample{row->time, *row->specific_force, *row->specific_force};
    };
    const std::optional<ImuSample> both =
        with_gravity_.next([&] { return half(this); }, [&] { return half(gravity.get()); });
    if (!both) return std::nullopt;
    LogReading reading;
    reading.time = both->time;
    reading.specific_force = both->angular_velocity_B + both->specific_force_B;
    return reading;
  }

  PlainCsv csv_;
  ImuHalves with_gravity_;
  std::optional<LogReading> ahead_;
  bool is_read_ = false;
};

FolderLog::~FolderLog() = default;

FolderLog::FolderLog(const std::filesystem::path& path, Diagnostics* diagnostics)
    : diagnostics_(diagnostics) {
  const std::vector<LogTable> tables = tablesIn(path);
  const RecordingFacts facts = factsOf(tables);
  choice_ = chooseTables(tables);
  if (choice_.isEmpty()) {
    throw InputError(fmt::format("{}: {}", path.string(),
                                 choice_.has_no_gravity
                                     ? "the accelerations are without gravity, and no table holds gravity"
                                     : "no table holds readings of a gyroscope, an accelerometer or a "
                                       "magnetometer"));
  }
  std::set<size_t> used;
  for (const std::optional<size_t>& table :
       {choice_.gyroscope, choice_.accelerometer, choice_.magnetometer}) {
    if (table && used.insert(*table).second) addStream(tables, *table, facts);
  }
  sensors_.has_gyroscope = choice_.gyroscope.has_value();
  sensors_.has_accelerometer = choice_.accelerometer.has_value();
  sensors_.has_magnetometer = choice_.magnetometer.has_value();
  sensors_.has_whole_imu = choice_.gyroscope && choice_.gyroscope == choice_.accelerometer;
  reportContent(path, tables, choice_, facts);
}

void FolderLog::addStream(const std::vector<LogTable>& tables, size_t table, const RecordingFacts& facts) {
  const auto open = [&](size_t index) {
    auto stream = std::make_unique<Stream>(tables[index], tableOptions(tables[index], facts), diagnostics_);
    stream->force_factor = facts.has_negative_forces ? -1.0 : 1.0;
    return stream;
  };
  std::unique_ptr<Stream> stream = open(table);
  stream->takes_gyroscope = choice_.gyroscope == table;
  stream->takes_accelerometer = choice_.accelerometer == table;
  stream->takes_magnetometer = choice_.magnetometer == table;
  if (stream->takes_accelerometer && choice_.gravity) {
    stream->gravity = open(*choice_.gravity);
    stream->gravity->takes_accelerometer = true;
  }
  if (stream->takes_magnetometer) sensors_.states_field_unit = stream->csv().statesFieldUnit();
  streams_.push_back(std::move(stream));
}

void FolderLog::reportContent(const std::filesystem::path& path, const std::vector<LogTable>& tables,
                              const TableChoice& choice, const RecordingFacts& facts) const {
  std::vector<std::string> parts;
  const auto add = [&](const char* sensor, const std::optional<size_t>& table, const std::string& unit) {
    if (table) parts.push_back(fmt::format("{} from {} {}", sensor, tables[*table].name, unit));
  };
  add("gyroscope", choice.gyroscope, "in rad/s");
  add("accelerometer", choice.accelerometer,
      choice.gravity ? "plus " + tables[*choice.gravity].name + " in m/s^2" : "in m/s^2");
  add("magnetometer", choice.magnetometer, sensors_.states_field_unit ? "in T" : "without a unit");
  diagnostics_->report(
      Severity::Notice, "log_content",
      fmt::format("{}: tables in one folder, converted: {}", path.string(), fmt::join(parts, "; ")));
  if (choice.has_no_gravity) {
    diagnostics_->report(Severity::Warning, "log_no_gravity",
                         path.string() +
                             ": the accelerations are without gravity and are not used; record "
                             "the total acceleration, or gravity too");
  }
  if (facts.has_negative_forces && choice.accelerometer) {
    diagnostics_->report(Severity::Notice, "log_axes",
                         path.string() +
                             ": accelerations of an iPhone; their sign is changed, so that they "
                             "point up at rest");
  }
}

bool FolderLog::next(LogReading* reading) {
  Stream* earliest = nullptr;
  for (const std::unique_ptr<Stream>& stream : streams_) {
    if (!stream->peek()) continue;
    if (earliest == nullptr || stream->peek()->time < earliest->peek()->time) earliest = stream.get();
  }
  if (earliest == nullptr) return false;
  *reading = earliest->take();
  return true;
}

}  // namespace lodeline
