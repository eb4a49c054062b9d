#include "lodeline/io/csv/plain_source.h"

#include <fmt/core.h>

#include "lodeline/diagnostics.h"
#include "lodeline/io/streams/stream_rate.h"

namespace lodeline {
namespace {

template <typename Reading>
std::optional<Reading> takeFirst(std::deque<Reading>* readings) {
  if (readings->empty()) return std::nullopt;
  const Reading reading = readings->front();
  readings->pop_front();
  return reading;
}

}  // namespace

PlainSource::PlainSource(const std::filesystem::path& file, Diagnostics* diagnostics)
    : RecordedSource(Rig()), csv_(file, diagnostics) {
  if (!csv_.hasGyroscope() || !csv_.hasAccelerometer()) {
    throw InputError(fmt::format("{}: has no gyroscope and accelerometer; both are needed", file.string()));
  }
  if (csv_.hasMagnetometer()) rig_.magnetometer.emplace();
  measureRate();
}

void PlainSource::measureRate() {
  while (imu_.size() < kStampsForRate && readRow()) {
  }
  std::vector<Time> stamps;
  for (const ImuSample& sample : imu_) stamps.push_back(sample.time);
  const std::optional<double> rate_hz = measuredRate_hz(stamps);
  if (!rate_hz) return;
  rig_.imu.rate_hz = *rate_hz;
  if (rig_.magnetometer) rig_.magnetometer->rate_hz = rig_.imu.rate_hz;
}

bool PlainSource::readRow() {
  PlainReading reading;
  if (!csv_.next(&reading)) return false;
  imu_.push_back({reading.time, *reading.angular_velocity, *reading.specific_force});
  if (reading.field) magnetometer_.push_back({reading.time, *reading.field});
  return true;
}

std::optional<ImuSample> PlainSource::nextRecordedImu() {
  if (imu_.empty()) readRow();
  return takeFirst(&imu_);
}

std::optional<MagnetometerSample> PlainSource::nextMagnetometer() {
  // Rows may have no field.
  while (magnetometer_.empty() && csv_.hasMagnetometer() && readRow()) {
  }
  return takeFirst(&magnetometer_);
}

}  // namespace lodeline
