#include "lodeline/magnetometer/calibration/magnetometer_record.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>

#include "lodeline/diagnostics.h"
#include "lodeline/io/euroc/csv_reader.h"
#include "lodeline/io/euroc/euroc_rig.h"
#include "lodeline/io/euroc/folder_calibration.h"
#include "lodeline/io/logs/open_sensor_log.h"
#include "lodeline/io/streams/imu_halves.h"
#include "lodeline/io/streams/inertial_screen.h"
#include "lodeline/io/streams/ordered_stream.h"
#include "lodeline/io/streams/time_span.h"

namespace lodeline {
namespace {

/// A record with its unit: as stated in the file, given by the user, or unknown.
struct Reading {
  MagnetometerRecord record;
  std::optional<FieldUnit> unit;
};

void readImu(const EurocLayout& layout, const RigFile& rig, const ShareDone& progress,
             MagnetometerRecord* record, Diagnostics* diagnostics) {
  if (rig.has_imu) {
    record->imu_noise = rig.rig.imu.noise;
  } else {
    diagnostics->report(
        Severity::Notice, "imu_noise_assumed",
        (layout.sensor("imu0") / "sensor.yaml").string() + ": missing; the noise of a usual IMU is assumed");
  }
  CsvReader csv(layout.csv("imu0"), CsvContent::Imu, diagnostics, kInertialRate);
  for (CsvRow row; csv.next(&row);) {
    progress(csv.shareRead().value_or(0.0));
    if (!record->imu.empty() && row.time <= record->imu.back().time) {
      diagnostics->report(Severity::Warning, "imu_order",
                          fmt::format("{}:{}: not later than the reading before; passed over",
                                      csv.file().string(), csv.line()));
      continue;
    }
    const ImuSample sample{row.time, Vec3(row.numbers.data()), Vec3(row.numbers.data() + 3)};
    record->imu.push_back(rig.imu_correction ? rig.imu_correction->applied(sample) : sample);
  }
}

/// The calibration of a recording, which may have none.
RigFile readCalibration(const EurocLayout& layout, Diagnostics* diagnostics) {
  Diagnostics found;
  RigFile rig = readFolderCalibration(layout, &found);
  for (const Finding& finding : found.ranked()) {
    if (finding.kind.ends_with("_uncalibrated")) continue;  // reported below
    diagnostics->report(finding.severity, finding.kind, finding.first_message);
  }
  return rig;
}

Reading readFolder(const std::filesystem::path& data, const ShareDone& progress, Diagnostics* diagnostics) {
  EurocOptions options;
  options.with_cameras = false;
  options.needs_imu = false;
  options.needs_calibration = false;
  const EurocLayout layout = findEurocLayout(data, options);
  const std::filesystem::path csv = layout.csv("mag0");
  if (!std::filesystem::exists(csv)) {
    throw InputError(csv.string() + ": missing; there are no magnetometer readings to calibrate from");
  }
  Reading reading;
  reading.unit = FieldUnit::Tesla;
  const RigFile rig = readCalibration(layout, diagnostics);
  if (layout.has_imu) readImu(layout, rig, progress, &reading.record, diagnostics);
  if (rig.rig.magnetometer) {
    reading.record.body_from_magnetometer = rig.rig.magnetometer->body_from_magnetometer.rotation;
  }
  CsvReader rows(csv, CsvContent::Magnetometer, diagnostics, kMagnetometerRate);
  for (CsvRow row; rows.next(&row);) {
    if (!layout.has_imu) progress(rows.shareRead().value_or(0.0));
    reading.record.magnetometer.push_back({row.time, Vec3(row.numbers.data())});
  }
  return reading;
}

Reading readLog(const std::filesystem::path& file, const RecordOptions& options, Diagnostics* diagnostics) {
  PlainCsvOptions table;
  table.is_magnetometer = true;
  const std::unique_ptr<SensorLog> log = openSensorLog(file, table, diagnostics);
  const LogSensors& sensors = log->sensors();
  if (!sensors.has_magnetometer) {
    throw InputError(file.string() + ": names no magnetometer columns (mx, my, mz, or x, y, z)");
  }
  if (options.unit && sensors.states_field_unit) {
    throw UsageError(file.string() +
                     ": --unit is for files that state no unit; correct the unit in its header");
  }
  Reading reading;
  if (sensors.states_field_unit) reading.unit = FieldUnit::Tesla;
  if (sensors.has_relative_field) reading.unit = FieldUnit::Raw;
  reading.record.has_times = sensors.has_times;
  std::deque<ImuSample> gyroscope, accelerometer;
  for (LogReading row; log->next(&row);) {
    if (row.field) reading.record.magnetometer.push_back({row.time, *row.field});
    if (row.angular_velocity) gyroscope.push_back({row.time, *row.angular_velocity, Vec3::Zero()});
    if (row.specific_force) accelerometer.push_back({row.time, Vec3::Zero(), *row.specific_force});
  }
  if (!sensors.has_times) return reading;
  ImuHalves halves;
  const auto take = [](std::deque<ImuSample>* from) -> std::optional<ImuSample> {
    if (from->empty()) return std::nullopt;
    const ImuSample first = from->front();
    from->pop_front();
    return first;
  };
  while (const auto sample =
             halves.next([&] { return take(&gyroscope); }, [&] { return take(&accelerometer); })) {
    const bool is_later = reading.record.imu.empty() || sample->time > reading.record.imu.back().time;
    if (is_later) reading.record.imu.push_back(*sample);
  }
  return reading;
}

void cut(const RecordOptions& options, MagnetometerRecord* record) {
  if (options.from_s == 0.0 && !options.to_s) return;
  if (!record->has_times) throw UsageError("--from and --to need a file with times; this one has none");
  const Time begin = record->magnetometer.front().time + Duration::fromSeconds(options.from_s);
  const Time end = options.to_s ? record->magnetometer.front().time + Duration::fromSeconds(*options.to_s)
                                : record->magnetometer.back().time;
  std::erase_if(record->magnetometer,
                [&](const auto& sample) { return sample.time < begin || sample.time > end; });
  // The inertial readings cover a little more time, for a magnetometer with a lag.
  const Duration margin = Duration::fromSeconds(0.5);
  std::erase_if(record->imu, [&](const auto& sample) {
    return sample.time < begin - margin || sample.time > end + margin;
  });
  if (record->magnetometer.empty()) throw UsageError("--from and --to leave no magnetometer reading");
}

/// Determines the unit for which the readings are plausible; warns where it is not the stated one.
void settleUnit(const std::string& data, const RecordOptions& options, std::optional<FieldUnit> stated,
                MagnetometerRecord* record, Diagnostics* diagnostics) {
  std::vector<Vec3> finite;
  for (const MagnetometerSample& sample : record->magnetometer) {
    if (sample.field_M.allFinite()) finite.push_back(sample.field_M);
  }
  const double size = fieldSize(finite);
  const FieldUnit by_size = unitBySize(size);
  FieldUnit unit = options.unit.value_or(stated.value_or(by_size));
  if (options.unit) {
    if (*options.unit != by_size && by_size != FieldUnit::Raw && *options.unit != FieldUnit::Raw) {
      diagnostics->report(Severity::Warning, "magnetometer_unit",
                          fmt::format("{}: a field of {:.4g} {} as asked for; by its size it is in {}", data,
                                      size, toString(unit), toString(by_size)));
    }
  } else if (!stated) {
    diagnostics->report(
        Severity::Warning, "magnetometer_unit",
        by_size == FieldUnit::Raw
            ? fmt::format("{}: no unit stated and a size, {:.4g}, that fits none; taken for raw counts "
                          "(--unit says otherwise)",
                          data, size)
            : fmt::format("{}: no unit stated; by the field's size, {:.4g}, it is {} (--unit says "
                          "otherwise)",
                          data, size, toString(by_size)));
  } else if (by_size != *stated && *stated != FieldUnit::Raw) {
    const bool other = by_size != FieldUnit::Raw;
    if (other) unit = by_size;
    diagnostics->report(Severity::Warning, "magnetometer_unit",
                        fmt::format("{}: a field of {:.4g} {}, while the Earth's is 22 to 67 uT; {}", data,
                                    size, toString(*stated),
                                    other ? fmt::format("it is taken to be in {}", toString(by_size))
                                          : std::string("check the unit, and for iron nearby")));
  }
  record->is_raw = unit == FieldUnit::Raw;
  for (MagnetometerSample& sample : record->magnetometer) sample.field_M *= teslaPer(unit);
}

Reading readSource(MeasurementSource& source, bool is_mounting_known, const ShareDone& progress,
                   Diagnostics* diagnostics) {
  Reading reading;
  reading.unit = FieldUnit::Tesla;
  reading.record.imu_noise = source.rig().imu.noise;
  if (is_mounting_known && source.rig().magnetometer) {
    reading.record.body_from_magnetometer = source.rig().magnetometer->body_from_magnetometer.rotation;
  }
  StreamExpectation expected{"imu", "IMU", 0.0, 0.0, Duration()};
  expected.spreads_bursts = true;
  OrderedStream<ImuSample> imu(
      expected, [&] { return source.nextImu(); }, diagnostics);
  const auto* recorded = dynamic_cast<const RecordedSource*>(&source);
  while (imu.peek() != nullptr) {
    reading.record.imu.push_back(imu.pop());
    if (recorded != nullptr) progress(recorded->shareRead().value_or(0.0));
  }
  while (const std::optional<MagnetometerSample> sample = source.nextMagnetometer()) {
    reading.record.magnetometer.push_back(*sample);
  }
  return reading;
}

/// Reports streams without common times, for which the gyroscope does not help the calibration.
void reportApart(const MagnetometerRecord& record, Diagnostics* diagnostics) {
  SpanOfStream imu, magnetometer;
  for (const ImuSample& sample : record.imu) imu.add(sample.time);
  for (const MagnetometerSample& sample : record.magnetometer) magnetometer.add(sample.time);
  if (!imu.get() || !magnetometer.get()) return;
  const std::optional<std::string> words =
      apart("the magnetometer", *magnetometer.get(), "the inertial readings", *imu.get(), "its clock");
  if (words) diagnostics->report(Severity::Serious, kClocksApart, *words);
}

MagnetometerRecord settled(Reading reading, const std::string& name, const RecordOptions& options,
                           Diagnostics* diagnostics) {
  if (reading.record.magnetometer.empty()) {
    throw InputError(name + ": holds no magnetometer reading that can be used");
  }
  reportApart(reading.record, diagnostics);
  cut(options, &reading.record);
  InertialScreenOptions screen;
  screen.knows_rate_unit = false;
  reading.record.imu = screened(reading.record.imu, screen, diagnostics);
  settleUnit(name, options, reading.unit, &reading.record, diagnostics);
  return std::move(reading.record);
}

}  // namespace

MagnetometerRecord readMagnetometerRecord(MeasurementSource& source, const std::string& name,
                                          bool is_mounting_known, const RecordOptions& options,
                                          Diagnostics* diagnostics) {
  return settled(readSource(source, is_mounting_known, options.progress, diagnostics), name, options,
                 diagnostics);
}

MagnetometerRecord readMagnetometerRecord(const std::filesystem::path& data, const RecordOptions& options,
                                          Diagnostics* diagnostics) {
  Reading reading = isSensorLog(data) ? readLog(data, options, diagnostics)
                                      : readFolder(data, options.progress, diagnostics);
  return settled(std::move(reading), data.string(), options, diagnostics);
}

}  // namespace lodeline
