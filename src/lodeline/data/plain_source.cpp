#include "lodeline/data/plain_source.h"

#include <fmt/core.h>

#include <algorithm>

#include "lodeline/base/error.h"

namespace lodeline {
namespace {

constexpr size_t kRowsForRate = 50;

template <typename Reading>
std::optional<Reading> takeFirst(std::deque<Reading>* readings) {
  if (readings->empty()) return std::nullopt;
  const Reading reading = readings->front();
  readings->pop_front();
  return reading;
}

}  // namespace

PlainSource::PlainSource(const std::filesystem::path& file, Diagnostics* diagnostics)
    : csv_(file, diagnostics) {
  if (!csv_.hasGyroscope() || !csv_.hasAccelerometer()) {
    throw InputError(fmt::format("{}: has no gyroscope and accelerometer; both are needed", file.string()));
  }
  if (csv_.hasMagnetometer()) rig_.magnetometer.emplace();
  measureRate();
}

void PlainSource::measureRate() {
  while (imu_.size() < kRowsForRate && readRow()) {
  }
  std::vector<double> steps_s;
  for (size_t i = 1; i < imu_.size(); ++i) {
    const double step_s = (imu_[i].time - imu_[i - 1].time).seconds();
    if (step_s > 0.0) steps_s.push_back(step_s);
  }
  if (steps_s.empty()) return;
  const auto middle = steps_s.begin() + static_cast<std::ptrdiff_t>(steps_s.size() / 2);
  std::nth_element(steps_s.begin(), middle, steps_s.end());
  rig_.imu.rate_hz = 1.0 / *middle;
  if (rig_.magnetometer) rig_.magnetometer->rate_hz = rig_.imu.rate_hz;
}

bool PlainSource::readRow() {
  PlainReading reading;
  if (!csv_.next(&reading)) return false;
  imu_.push_back({reading.time, *reading.angular_velocity, *reading.specific_force});
  if (reading.field) magnetometer_.push_back({reading.time, *reading.field});
  return true;
}

std::optional<ImuSample> PlainSource::nextImu() {
  if (imu_.empty()) readRow();
  return takeFirst(&imu_);
}

std::optional<MagnetometerSample> PlainSource::nextMagnetometer() {
  if (magnetometer_.empty() && csv_.hasMagnetometer()) readRow();
  return takeFirst(&magnetometer_);
}

}  // namespace lodeline
