#include "lodeline/io/logs/binary/autopilot_log.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

void put(LogSensor sensor, const std::array<double, 3>& value, LogReading* reading) {
  const Vec3 vector(value[0], value[1], value[2]);
  if (sensor == LogSensor::Gyroscope) reading->angular_velocity = vector;
  if (sensor == LogSensor::Accelerometer) reading->specific_force = vector;
  if (sensor == LogSensor::Magnetometer) reading->field = vector;
  if (sensor == LogSensor::Pressure) reading->pressure_Pa = value[0];
}

}  // namespace

AutopilotLog::AutopilotLog(const Open& open, std::string file, const std::string& program,
                           Diagnostics* diagnostics)
    : file_(std::move(file)), diagnostics_(diagnostics) {
  channels_ = selectChannels(open().get(), file_);
  const auto find = [&](LogSensor sensor) {
    return std::find_if(channels_.begin(), channels_.end(),
                        [&](const LogChannel& channel) { return channel.sensor == sensor; });
  };
  const auto gyroscope = find(LogSensor::Gyroscope), accelerometer = find(LogSensor::Accelerometer);
  sensors_.has_gyroscope = gyroscope != channels_.end();
  sensors_.has_accelerometer = accelerometer != channels_.end();
  sensors_.has_magnetometer = find(LogSensor::Magnetometer) != channels_.end();
  sensors_.states_field_unit = true;
  size_t most = 0;
  for (const LogChannel& channel : channels_) {
    if (channel.sensor != LogSensor::Current) continue;
    if (channel.messages > most) sensors_.fastest_current = sensors_.current_channels.size();
    most = std::max(most, channel.messages);
    sensors_.current_channels.push_back(channel.name);
  }
  sensors_.has_whole_imu = sensors_.has_gyroscope && sensors_.has_accelerometer &&
                           gyroscope->topic == accelerometer->topic && !accelerometer->has_relative_time &&
                           gyroscope->instance == accelerometer->instance;
  if (!sensors_.has_gyroscope && !sensors_.has_accelerometer && !sensors_.has_magnetometer) {
    throw InputError(
        fmt::format("{}: {} without messages of a gyroscope, an accelerometer or a "
                    "magnetometer; log the sensors, for example IMU and MAG, or sensor_combined",
                    file_, program));
  }
  reportContent(program);
  log_ = open();
}

void AutopilotLog::reportContent(const std::string& program) const {
  std::vector<std::string> parts;
  bool is_documented = false;
  for (const LogChannel& channel : channels_) {
    is_documented = is_documented || !channel.is_unit_stated;
    parts.push_back(fmt::format("{} from {} {} in {} ({} messages)", toString(channel.sensor), channel.topic,
                                channel.instance, channel.unit, channel.messages));
    if (channel.unused.empty()) continue;
    diagnostics_->report(Severity::Notice, "log_other_sources",
                         fmt::format("{}: {}: {} {} is used; not {}", file_, toString(channel.sensor),
                                     channel.topic, channel.instance, fmt::join(channel.unused, ", ")));
  }
  diagnostics_->report(Severity::Notice, "log_content",
                       fmt::format("{}: {}: {}{}", file_, program, fmt::join(parts, "; "),
                                   is_documented ? "; units by its documentation" : ""));
}

void AutopilotLog::reportDamage() {
  const LogDamage& damage = log_->damage();
  if (damage.places > 0) {
    diagnostics_->report(Severity::Warning, "log_damaged",
                         fmt::format("{}: {} bytes in {} places are no messages; they are passed over", file_,
                                     damage.bytes, damage.places));
  }
  if (damage.is_cut_off) {
    diagnostics_->report(Severity::Notice, "log_cut_off", file_ + ": ends within a message");
  }
}

void AutopilotLog::take(const LogMessage& message) {
  LogReading reading;
  bool has_any = false;
  for (const LogChannel& channel : channels_) {
    if (channel.instance != message.instance || channel.topic != message.format->topic) continue;
    const std::optional<std::array<double, 3>> value = readingOf(channel, message);
    if (!value) {
      diagnostics_->report(Severity::Warning, "log_reading",
                           fmt::format("{}: a message {} without a finite {} reading; passed over", file_,
                                       channel.topic, toString(channel.sensor)));
      continue;
    }
    put(channel.sensor, *value, &reading);
    if (channel.sensor == LogSensor::Current) {
      const std::vector<std::string>& names = sensors_.current_channels;
      const auto place = std::find(names.begin(), names.end(), channel.name) - names.begin();
      reading.currents.push_back({static_cast<size_t>(place), (*value)[0]});
    }
    has_any = true;
  }
  const std::optional<int64_t> time_ns = has_any ? timeOf_ns(message) : std::nullopt;
  if (!time_ns) return;
  reading.time = Time::fromNanoseconds(*time_ns);
  const bool is_half =
      sensors_.has_whole_imu && reading.angular_velocity.has_value() != reading.specific_force.has_value();
  if (is_half) {
    reading.angular_velocity.reset();
    reading.specific_force.reset();
    if (!reading.field && !reading.pressure_Pa && reading.currents.empty()) return;
  }
  if (!sensors_.has_whole_imu && reading.specific_force && reading.angular_velocity) {
    LogReading force;
    force.time = Time::fromNanoseconds(*time_ns + relativeTime_ns(message));
    force.specific_force = std::exchange(reading.specific_force, std::nullopt);
    waiting_.push_back(force);
  }
  waiting_.push_back(reading);
}

bool AutopilotLog::next(LogReading* reading) {
  LogMessage message;
  while (waiting_.empty()) {
    if (log_ == nullptr) return false;
    if (log_->next(&message)) {
      take(message);
      continue;
    }
    reportDamage();
    log_.reset();
  }
  *reading = waiting_.front();
  waiting_.pop_front();
  return true;
}

}  // namespace lodeline
