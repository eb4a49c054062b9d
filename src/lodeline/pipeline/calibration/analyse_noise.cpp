#include "lodeline/pipeline/calibration/analyse_noise.h"

#include <filesystem>
#include <memory>
#include <optional>

#include "lodeline/io/euroc/csv_reader.h"
#include "lodeline/io/euroc/euroc_rig.h"
#include "lodeline/io/logs/open_sensor_log.h"

namespace lodeline {
namespace {

/// The part of the record to be analysed, counted from its first reading.
class Part {
 public:
  explicit Part(const NoiseRequest& request) : request_(request) {}
  bool holds(Time time) {
    if (!first_) first_ = time;
    const double t = (time - *first_).seconds();
    return t >= request_.skip_s && (request_.duration_s == 0.0 || t <= request_.skip_s + request_.duration_s);
  }

 private:
  const NoiseRequest& request_;
  std::optional<Time> first_;
};

/// Analyses of the available ones of the three sensors.
class Analyses {
 public:
  explicit Analyses(Diagnostics* diagnostics)
      : gyroscope(gyroscopeToAnalyse(), diagnostics),
        accelerometer(accelerometerToAnalyse(), diagnostics),
        magnetometer(magnetometerToAnalyse(), diagnostics) {}

  SensorNoiseAnalysis gyroscope, accelerometer, magnetometer;
  bool has_gyroscope = false, has_accelerometer = false, has_magnetometer = false;

  std::vector<SensorNoise> finish() {
    std::vector<SensorNoise> sensors;
    if (has_gyroscope) sensors.push_back(gyroscope.finish());
    if (has_accelerometer) sensors.push_back(accelerometer.finish());
    if (has_magnetometer) sensors.push_back(magnetometer.finish());
    return sensors;
  }
};

void readFolder(const NoiseRequest& request, Diagnostics* diagnostics, Analyses* analyses) {
  EurocOptions options;
  options.with_cameras = false;
  options.needs_imu = false;
  const EurocLayout layout = findEurocLayout(request.data, options);
  CsvRow row;
  if (layout.has_imu) {
    analyses->has_gyroscope = analyses->has_accelerometer = true;
    CsvReader imu(layout.csv("imu0"), CsvContent::Imu, diagnostics, kInertialRate);
    for (Part part(request); imu.next(&row);) {
      request.progress(imu.shareRead().value_or(0.0));
      if (!part.holds(row.time)) continue;
      analyses->gyroscope.add(row.time, Vec3(row.numbers.data()));
      analyses->accelerometer.add(row.time, Vec3(row.numbers.data() + 3));
    }
  }
  if (!std::filesystem::exists(layout.csv("mag0"))) return;
  analyses->has_magnetometer = true;
  CsvReader magnetometer(layout.csv("mag0"), CsvContent::Magnetometer, diagnostics, kMagnetometerRate);
  for (Part part(request); magnetometer.next(&row);) {
    if (!layout.has_imu) request.progress(magnetometer.shareRead().value_or(0.0));
    if (part.holds(row.time)) analyses->magnetometer.add(row.time, Vec3(row.numbers.data()));
  }
}

void readRecording(const NoiseRequest& request, Diagnostics* diagnostics, Analyses* analyses) {
  const std::unique_ptr<RecordedSource> source = openReadings(request.data, request.bag, diagnostics).source;
  Part imu_part(request);
  while (const std::optional<ImuSample> sample = source->nextImu()) {
    analyses->has_gyroscope = analyses->has_accelerometer = true;
    request.progress(source->shareRead().value_or(0.0));
    if (!imu_part.holds(sample->time)) continue;
    analyses->gyroscope.add(sample->time, sample->angular_velocity_B);
    analyses->accelerometer.add(sample->time, sample->specific_force_B);
  }
  Part magnetometer_part(request);
  while (const std::optional<MagnetometerSample> sample = source->nextMagnetometer()) {
    analyses->has_magnetometer = true;
    if (magnetometer_part.holds(sample->time)) analyses->magnetometer.add(sample->time, sample->field_M);
  }
  if (analyses->has_gyroscope || analyses->has_magnetometer) return;
  throw InputError(request.data + ": holds no readings of an IMU or a magnetometer");
}

void readLog(const NoiseRequest& request, Diagnostics* diagnostics, Analyses* analyses) {
  const std::unique_ptr<SensorLog> log = openSensorLog(request.data, {}, diagnostics);
  analyses->has_gyroscope = log->sensors().has_gyroscope;
  analyses->has_accelerometer = log->sensors().has_accelerometer;
  analyses->has_magnetometer = log->sensors().has_magnetometer;
  LogReading reading;
  for (Part part(request); log->next(&reading);) {
    if (!part.holds(reading.time)) continue;
    if (reading.angular_velocity) analyses->gyroscope.add(reading.time, *reading.angular_velocity);
    if (reading.specific_force) analyses->accelerometer.add(reading.time, *reading.specific_force);
    if (reading.field) analyses->magnetometer.add(reading.time, *reading.field);
  }
}

}  // namespace

std::vector<SensorNoise> analyseNoise(const NoiseRequest& request, Diagnostics* diagnostics) {
  Analyses analyses(diagnostics);
  refuseBagOptions(request.data, request.bag);
  refuseRigOfFolder(request.data, request.bag);
  if (isBag(request.data) || isVideo(request.data)) {
    readRecording(request, diagnostics, &analyses);
  } else if (isSensorLog(request.data)) {
    readLog(request, diagnostics, &analyses);
  } else {
    readFolder(request, diagnostics, &analyses);
  }
  return analyses.finish();
}

}  // namespace lodeline
