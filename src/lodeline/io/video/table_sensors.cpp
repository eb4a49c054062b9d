#include "lodeline/io/video/table_sensors.h"

#include <fmt/core.h>

#include "lodeline/diagnostics.h"
#include "lodeline/io/streams/stream_rate.h"

namespace lodeline {
namespace {

constexpr double kMicrotesla = 1e-6;

/// The first stamps of a sensor from a separate reader.
template <typename Next>
std::vector<Time> firstStamps(const Next& next) {
  std::vector<Time> stamps;
  while (stamps.size() < kStampsForRate) {
    const auto reading = next();
    if (!reading) break;
    stamps.push_back(reading->time);
  }
  return stamps;
}

}  // namespace

TableSensors::TableSensors(const VideoFolder& folder, Diagnostics* diagnostics) {
  Diagnostics reported_when_read_in_earnest;
  if (folder.gyroscope == folder.accelerometer) {
    both_.emplace(folder.gyroscope, diagnostics);
    if (!both_->hasGyroscope() || !both_->hasAccelerometer()) {
      throw InputError(folder.gyroscope.string() + ": has no gyroscope and accelerometer");
    }
    PlainCsv ahead(folder.gyroscope, &reported_when_read_in_earnest);
    imu_stamps_ = firstStamps([&]() -> std::optional<PlainReading> {
      PlainReading reading;
      return ahead.next(&reading) ? std::optional(reading) : std::nullopt;
    });
  } else {
    gyroscope_.emplace(folder.gyroscope, Quantity::AngularRate, 1.0, diagnostics);
    accelerometer_.emplace(folder.accelerometer, Quantity::SpecificForce, 1.0, diagnostics);
    AxisTable ahead(folder.gyroscope, Quantity::AngularRate, 1.0, &reported_when_read_in_earnest);
    imu_stamps_ = firstStamps([&] { return ahead.next(); });
  }
  addFacts("gyroscope", folder.gyroscope, imu_stamps_);
  if (folder.magnetometer.empty()) return;
  magnetometer_.emplace(folder.magnetometer, Quantity::MagneticField, kMicrotesla, diagnostics);
  AxisTable ahead(folder.magnetometer, Quantity::MagneticField, kMicrotesla, &reported_when_read_in_earnest);
  magnetometer_stamps_ = firstStamps([&] { return ahead.next(); });
  addFacts("magnetometer", folder.magnetometer, magnetometer_stamps_);
}

void TableSensors::addFacts(const char* key, const std::filesystem::path& file,
                            const std::vector<Time>& stamps) {
  VideoStreamFacts facts;
  facts.key = key;
  facts.name = file.string();
  facts.rate_hz = measuredRate_hz(stamps).value_or(0.0);
  facts_.push_back(std::move(facts));
}

std::optional<ImuSample> TableSensors::nextImu() {
  if (both_) {
    PlainReading reading;
    if (!both_->next(&reading)) return std::nullopt;
    return ImuSample{reading.time, *reading.angular_velocity, *reading.specific_force};
  }
  return halves_.next(
      [this]() -> std::optional<ImuSample> {
        const std::optional<AxisTable::Reading> reading = gyroscope_->next();
        if (!reading) return std::nullopt;
        return ImuSample{reading->time, reading->value, Vec3::Zero()};
      },
      [this]() -> std::optional<ImuSample> {
        const std::optional<AxisTable::Reading> reading = accelerometer_->next();
        if (!reading) return std::nullopt;
        return ImuSample{reading->time, Vec3::Zero(), reading->value};
      });
}

std::optional<MagnetometerSample> TableSensors::nextMagnetometer() {
  if (!magnetometer_) return std::nullopt;
  const std::optional<AxisTable::Reading> reading = magnetometer_->next();
  if (!reading) return std::nullopt;
  return MagnetometerSample{reading->time, reading->value};
}

}  // namespace lodeline
