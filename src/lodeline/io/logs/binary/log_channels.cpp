#include "lodeline/io/logs/binary/log_channels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "lodeline/diagnostics.h"
#include "lodeline/io/tables/units.h"

namespace lodeline {
namespace {

/// Fields of a topic that hold a sensor, and their documented unit.
struct Rule {
  LogSensor sensor;
  const char* topic;
  std::array<const char*, 3> fields;  ///< the first alone for a scalar
  const char* unit;
  const char* group = nullptr;  ///< of a channel of currents
  int member = -1;              ///< number of the channel; by default, that of the instance
};

constexpr const char* kBattery = "battery";
constexpr const char* kEsc = "esc";
constexpr const char* kPascalOrHectopascal = "Pa or hPa";
constexpr const char* kRelativeTime = "accelerometer_timestamp_relative";

// PX4: "uORB Message Reference" of its documentation. ArduPilot: "Onboard Message Log Messages" of its.
constexpr Rule kRules[] = {
    {LogSensor::Gyroscope, "sensor_combined", {"gyro_rad[0]", "gyro_rad[1]", "gyro_rad[2]"}, "rad/s"},
    {LogSensor::Gyroscope, "sensor_gyro", {"x", "y", "z"}, "rad/s"},
    {LogSensor::Gyroscope, "IMU", {"GyrX", "GyrY", "GyrZ"}, "rad/s"},
    {LogSensor::Gyroscope, "GYR", {"GyrX", "GyrY", "GyrZ"}, "rad/s"},
    {LogSensor::Gyroscope, "IMU2", {"GyrX", "GyrY", "GyrZ"}, "rad/s"},
    {LogSensor::Accelerometer,
     "sensor_combined",
     {"accelerometer_m_s2[0]", "accelerometer_m_s2[1]", "accelerometer_m_s2[2]"},
     "m/s^2"},
    {LogSensor::Accelerometer, "sensor_accel", {"x", "y", "z"}, "m/s^2"},
    {LogSensor::Accelerometer, "IMU", {"AccX", "AccY", "AccZ"}, "m/s^2"},
    {LogSensor::Accelerometer, "ACC", {"AccX", "AccY", "AccZ"}, "m/s^2"},
    {LogSensor::Accelerometer, "IMU2", {"AccX", "AccY", "AccZ"}, "m/s^2"},
    {LogSensor::Magnetometer, "sensor_mag", {"x", "y", "z"}, "gauss"},
    {LogSensor::Magnetometer,
     "vehicle_magnetometer",
     {"magnetometer_ga[0]", "magnetometer_ga[1]", "magnetometer_ga[2]"},
     "gauss"},
    {LogSensor::Magnetometer,
     "sensor_combined",
     {"magnetometer_ga[0]", "magnetometer_ga[1]", "magnetometer_ga[2]"},
     "gauss"},
    {LogSensor::Magnetometer, "MAG", {"MagX", "MagY", "MagZ"}, "mgauss"},
    {LogSensor::Magnetometer, "MAG2", {"MagX", "MagY", "MagZ"}, "mgauss"},
    {LogSensor::Pressure, "vehicle_air_data", {"baro_pressure_pa"}, "Pa"},
    {LogSensor::Pressure, "sensor_baro", {"pressure"}, kPascalOrHectopascal},
    {LogSensor::Pressure, "BARO", {"Press"}, "Pa"},
    {LogSensor::Current, "battery_status", {"current_a"}, "A", kBattery},
    {LogSensor::Current, "BAT", {"Curr"}, "A", kBattery},
    {LogSensor::Current, "CURR", {"Curr"}, "A", kBattery},
    {LogSensor::Current, "ESC", {"Curr"}, "A", kEsc},
    {LogSensor::Current, "esc_status", {"esc[0].esc_current"}, "A", kEsc, 0},
    {LogSensor::Current, "esc_status", {"esc[1].esc_current"}, "A", kEsc, 1},
    {LogSensor::Current, "esc_status", {"esc[2].esc_current"}, "A", kEsc, 2},
    {LogSensor::Current, "esc_status", {"esc[3].esc_current"}, "A", kEsc, 3},
    {LogSensor::Current, "esc_status", {"esc[4].esc_current"}, "A", kEsc, 4},
    {LogSensor::Current, "esc_status", {"esc[5].esc_current"}, "A", kEsc, 5},
    {LogSensor::Current, "esc_status", {"esc[6].esc_current"}, "A", kEsc, 6},
    {LogSensor::Current, "esc_status", {"esc[7].esc_current"}, "A", kEsc, 7},
};

/// A topic with one instance of a sensor, and what was seen of it.
struct Source {
  size_t rank = 0;  ///< of its rule
  int instance = 0;
  auto operator<=>(const Source&) const = default;
};
struct Seen {
  size_t messages = 0;
  std::string unit;  ///< stated by the log; empty where there is none
  bool has_relative_time = false;
  bool has_current = false;  ///< other than 0
};
using Sources = std::map<Source, Seen>;

bool hasFields(const LogFormat& format, const Rule& rule) {
  return std::all_of(rule.fields.begin(), rule.fields.end(),
                     [&](const char* name) { return name == nullptr || format.field(name) != nullptr; });
}

std::optional<double> toSi(LogSensor sensor, const std::string& unit) {
  switch (sensor) {
    case LogSensor::Gyroscope:
      return unitFactor(Quantity::AngularRate, unit);
    case LogSensor::Accelerometer:
      return unitFactor(Quantity::SpecificForce, unit);
    case LogSensor::Magnetometer:
      return unitFactor(Quantity::MagneticField, unit);
    case LogSensor::Pressure:
      return unit == "Pa" ? std::optional(1.0) : unit == "hPa" ? std::optional(100.0) : std::nullopt;
    case LogSensor::Current:
      return unit == "A" ? std::optional(1.0) : std::nullopt;
  }
  return std::nullopt;
}

LogChannel channelOf(const Source& source, const Seen& seen, const std::string& file) {
  const Rule& rule = kRules[source.rank];
  LogChannel channel;
  channel.sensor = rule.sensor;
  channel.topic = rule.topic;
  channel.instance = source.instance;
  channel.messages = seen.messages;
  channel.has_relative_time = seen.has_relative_time;
  if (rule.group != nullptr)
    channel.name = fmt::format("{}_{}", rule.group, rule.member < 0 ? source.instance : rule.member);
  for (const char* field : rule.fields) {
    if (field != nullptr) channel.fields.emplace_back(field);
  }
  channel.is_unit_stated = !seen.unit.empty();
  channel.unit = channel.is_unit_stated ? seen.unit : rule.unit;
  channel.to_si = toSi(rule.sensor, channel.unit);
  if (!channel.to_si && channel.unit != kPascalOrHectopascal) {
    throw InputError(fmt::format("{}: the log states the unit '{}' for {} in {}, which is not known", file,
                                 channel.unit, channel.fields.front(), channel.topic));
  }
  return channel;
}

}  // namespace

const char* toString(LogSensor sensor) {
  constexpr const char* kNames[] = {"gyroscope", "accelerometer", "magnetometer", "pressure", "current"};
  return kNames[static_cast<size_t>(sensor)];
}

namespace {

Sources sourcesOf(MessageLog* log) {
  Sources sources;
  for (LogMessage message; log->next(&message);) {
    for (size_t rank = 0; rank < std::size(kRules); ++rank) {
      const Rule& rule = kRules[rank];
      if (message.format->topic != rule.topic || !hasFields(*message.format, rule)) continue;
      const LogField& field = *message.format->field(rule.fields[0]);
      Seen& seen = sources[{rank, message.instance}];
      if (rule.group != nullptr && !seen.has_current)
        seen.has_current = message.value(field).value_or(0.0) != 0.0;
      if (seen.messages++ > 0) continue;
      seen.unit = field.unit;
      seen.has_relative_time = message.format->field(kRelativeTime) != nullptr;
    }
  }
  return sources;
}

/// The first source of a kind that has at least half of the messages of the most frequent one.
template <typename IsWanted>
Sources::const_iterator chosenOf(const Sources& sources, const IsWanted& is_wanted) {
  size_t most = 0;
  for (const auto& entry : sources) {
    if (is_wanted(entry)) most = std::max(most, entry.second.messages);
  }
  return std::find_if(sources.begin(), sources.end(), [&](const auto& entry) {
    return is_wanted(entry) && 2 * entry.second.messages >= most;
  });
}

/// Adds all channels of the topic that is chosen for a group of currents.
void addCurrents(const Sources& sources, const std::string& group, const std::string& file,
                 std::vector<LogChannel>* channels) {
  const auto isOfGroup = [&](const auto& entry) {
    const Rule& rule = kRules[entry.first.rank];
    return rule.group != nullptr && rule.group == group && entry.second.has_current;
  };
  const auto chosen = chosenOf(sources, isOfGroup);
  if (chosen == sources.end()) return;
  const std::string topic = kRules[chosen->first.rank].topic;
  for (const auto& entry : sources) {
    if (isOfGroup(entry) && kRules[entry.first.rank].topic == topic)
      channels->push_back(channelOf(entry.first, entry.second, file));
  }
}

}  // namespace

std::vector<LogChannel> selectChannels(MessageLog* log, const std::string& file) {
  const Sources sources = sourcesOf(log);
  std::vector<LogChannel> channels;
  for (size_t sensor = 0; sensor < kLogSensors; ++sensor) {
    const auto isOfSensor = [&](const auto& entry) {
      return kRules[entry.first.rank].sensor == static_cast<LogSensor>(sensor);
    };
    if (static_cast<LogSensor>(sensor) == LogSensor::Current) continue;
    const auto chosen = chosenOf(sources, isOfSensor);
    if (chosen == sources.end()) continue;
    channels.push_back(channelOf(chosen->first, chosen->second, file));
    for (const auto& entry : sources) {
      if (!isOfSensor(entry) || entry.first == chosen->first) continue;
      channels.back().unused.push_back(fmt::format("{} {} ({})", kRules[entry.first.rank].topic,
                                                   entry.first.instance, entry.second.messages));
    }
  }
  for (const char* group : {kBattery, kEsc}) addCurrents(sources, group, file, &channels);
  return channels;
}

std::optional<int64_t> timeOf_ns(const LogMessage& message) {
  struct TimeField {
    const char* name;
    int64_t ns_per_count;
  };
  constexpr TimeField kTimes[] = {{"timestamp_sample", 1000},
                                  {"SampleUS", 1000},
                                  {"timestamp", 1000},
                                  {"TimeUS", 1000},
                                  {"TimeMS", 1000000}};
  for (const TimeField& time : kTimes) {
    const LogField* field = message.format->field(time.name);
    const std::optional<int64_t> count = field == nullptr ? std::nullopt : message.count(*field);
    const bool is_time =
        count && *count > 0 && *count < std::numeric_limits<int64_t>::max() / time.ns_per_count;
    if (is_time) return *count * time.ns_per_count;
  }
  return std::nullopt;
}

int64_t relativeTime_ns(const LogMessage& message) {
  constexpr int64_t kInvalid_us = std::numeric_limits<int32_t>::max(), kNanosecondsPerMicrosecond = 1000;
  const LogField* field = message.format->field(kRelativeTime);
  const std::optional<int64_t> delay_us = field == nullptr ? std::nullopt : message.count(*field);
  const bool is_valid = delay_us && std::abs(*delay_us) < kInvalid_us;
  return is_valid ? *delay_us * kNanosecondsPerMicrosecond : 0;
}

std::optional<std::array<double, 3>> readingOf(const LogChannel& channel, const LogMessage& message) {
  // PX4's topic sensor_baro changed from hPa to Pa in version 1.14. No barometer measures 20 000 hPa, nor
  // less than 20 000 Pa.
  constexpr double kMostHectopascals = 20'000.0, kPascalsPerHectopascal = 100.0;
  std::array<double, 3> reading = {};
  for (size_t i = 0; i < channel.fields.size(); ++i) {
    const LogField* field = message.format->field(channel.fields[i]);
    const std::optional<double> value = field == nullptr ? std::nullopt : message.value(*field);
    if (!value || !std::isfinite(*value)) return std::nullopt;
    const double guessed = *value < kMostHectopascals ? kPascalsPerHectopascal : 1.0;
    reading[i] = *value * channel.to_si.value_or(guessed);
  }
  return reading;
}

}  // namespace lodeline
