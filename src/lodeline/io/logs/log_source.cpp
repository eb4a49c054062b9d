#include "lodeline/io/logs/log_source.h"

#include <fmt/core.h>

#include <algorithm>

#include "lodeline/diagnostics.h"
#include "lodeline/io/logs/open_sensor_log.h"
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

template <typename Reading>
void measureRate(const std::deque<Reading>& readings, double* rate_hz) {
  std::vector<Time> stamps;
  for (const Reading& reading : readings) stamps.push_back(reading.time);
  if (const std::optional<double> measured_hz = measuredRate_hz(stamps)) *rate_hz = *measured_hz;
}

}  // namespace

LogSource::LogSource(const std::filesystem::path& file, Diagnostics* diagnostics)
    : RecordedSource(Rig()), log_(openSensorLog(file, {}, diagnostics)) {
  if (!log_->sensors().has_gyroscope || !log_->sensors().has_accelerometer) {
    throw InputError(fmt::format("{}: has no gyroscope and accelerometer; both are needed", file.string()));
  }
  if (log_->sensors().has_magnetometer) rig_.magnetometer.emplace();
  if (!log_->sensors().current_channels.empty()) {
    rig_.currents.emplace().channels = log_->sensors().current_channels;
    last_currents_A_.resize(rig_.currents->channels.size());
  }
  measureRates();
}

void LogSource::measureRates() {
  constexpr int kMostReadings = 50'000;  // for a magnetometer that is slow or silent
  const auto needsMore = [&] {
    return std::max(imu_.size(), gyroscope_.size()) < kStampsForRate ||
           (rig_.magnetometer && magnetometer_.size() < kStampsForRate);
  };
  for (int i = 0; i < kMostReadings && needsMore() && readOne(); ++i) {
  }
  measureRate(log_->sensors().has_whole_imu ? imu_ : gyroscope_, &rig_.imu.rate_hz);
  if (rig_.magnetometer) measureRate(magnetometer_, &rig_.magnetometer->rate_hz);
  if (rig_.currents) measureRate(currents_, &rig_.currents->rate_hz);
}

bool LogSource::readOne() {
  LogReading reading;
  if (!log_->next(&reading)) return false;
  ImuSample sample;
  sample.time = reading.time;
  sample.angular_velocity_B = reading.angular_velocity.value_or(Vec3::Zero());
  sample.specific_force_B = reading.specific_force.value_or(Vec3::Zero());
  if (log_->sensors().has_whole_imu) {
    if (reading.angular_velocity) imu_.push_back(sample);
  } else {
    if (reading.angular_velocity) gyroscope_.push_back(sample);
    if (reading.specific_force) accelerometer_.push_back(sample);
  }
  if (reading.field) magnetometer_.push_back({reading.time, *reading.field});
  takeCurrents(reading);
  return true;
}

void LogSource::takeCurrents(const LogReading& reading) {
  bool is_due = false;
  for (const LogCurrent& current : reading.currents) {
    last_currents_A_[current.channel] = current.current_A;
    is_due = is_due || current.channel == log_->sensors().fastest_current;
  }
  CurrentSample sample;
  sample.time = reading.time;
  for (const std::optional<double>& current_A : last_currents_A_) {
    if (!current_A) return;  // a channel that has not begun yet
    sample.currents_A.push_back(*current_A);
  }
  if (is_due) currents_.push_back(std::move(sample));
}

std::optional<ImuSample> LogSource::takeHalf(std::deque<ImuSample>* readings) {
  while (readings->empty() && readOne()) {
  }
  return takeFirst(readings);
}

std::optional<ImuSample> LogSource::nextRecordedImu() {
  if (log_->sensors().has_whole_imu) return takeHalf(&imu_);
  return halves_.next([&] { return takeHalf(&gyroscope_); }, [&] { return takeHalf(&accelerometer_); });
}

std::optional<MagnetometerSample> LogSource::nextMagnetometer() {
  while (rig_.magnetometer && magnetometer_.empty() && readOne()) {
  }
  return takeFirst(&magnetometer_);
}

std::optional<CurrentSample> LogSource::nextCurrents() {
  while (rig_.currents && currents_.empty() && readOne()) {
  }
  return takeFirst(&currents_);
}

}  // namespace lodeline
