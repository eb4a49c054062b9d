#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/types.h"

/// A small writer of GPMF for tests, after the documentation of the format.
namespace lodeline::test {

using Bytes = std::vector<uint8_t>;

inline void putBigEndian(uint64_t bits, size_t size, Bytes* bytes) {
  for (size_t i = size; i-- > 0;) bytes->push_back(static_cast<uint8_t>(bits >> (8 * i)));
}

inline void append(const Bytes& more, Bytes* bytes) { bytes->insert(bytes->end(), more.begin(), more.end()); }

/// An element with padding.
inline Bytes element(const std::string& key, char type, size_t size, size_t repeats, const Bytes& content) {
  Bytes bytes(key.begin(), key.end());
  bytes.push_back(static_cast<uint8_t>(type));
  bytes.push_back(static_cast<uint8_t>(size));
  putBigEndian(repeats, 2, &bytes);
  append(content, &bytes);
  while (bytes.size() % 4 != 0) bytes.push_back(0);
  return bytes;
}

inline Bytes nested(const std::string& key, const std::vector<Bytes>& parts) {
  Bytes content;
  for (const Bytes& part : parts) append(part, &content);
  return element(key, '\0', 4, content.size() / 4, content);
}

inline Bytes text(const std::string& key, const std::string& value) {
  return element(key, 'c', 1, value.size(), Bytes(value.begin(), value.end()));
}

inline Bytes number32(const std::string& key, uint32_t value) {
  Bytes content;
  putBigEndian(value, 4, &content);
  return element(key, 'L', 4, 1, content);
}

inline Bytes number64(const std::string& key, uint64_t value) {
  Bytes content;
  putBigEndian(value, 8, &content);
  return element(key, 'J', 8, 1, content);
}

inline Bytes floats(const std::string& key, size_t axes, const std::vector<float>& values) {
  Bytes content;
  for (const float value : values) putBigEndian(std::bit_cast<uint32_t>(value), 4, &content);
  return element(key, 'f', 4 * axes, values.size() / axes, content);
}

inline Bytes shorts(const std::string& key, size_t axes, const std::vector<int>& values) {
  Bytes content;
  for (const int value : values)
    putBigEndian(static_cast<uint16_t>(static_cast<int16_t>(value)), 2, &content);
  return element(key, 's', 2 * axes, values.size() / axes, content);
}

/// A simulated sensor: sample n is taken at start_s + n / rate_hz on the clock of the images.
struct TestSensor {
  std::string key = "GYRO";
  std::string unit = "rad/s";
  std::string stored_axes = "";  ///< ORIN
  double rate_hz = 200.0;
  double start_s = 0.0;
  int scale = 1000;
  std::function<Vec3(double)> stored = [](double) { return Vec3::Zero(); };  ///< by time, stored order
  std::optional<double> clock_s = std::nullopt;  ///< STMP: camera's clock at the images' zero
  size_t burst = 1;                              ///< samples are handed over in groups of so many
};

/// Payloads of one second with the samples that were taken until then.
inline std::vector<Bytes> payloadsOf(const std::vector<TestSensor>& sensors, int count,
                                     const std::string& device = "HERO9 Black", double period_s = 1.0) {
  std::vector<Bytes> payloads;
  std::vector<size_t> next(sensors.size(), 0);
  for (int k = 0; k < count; ++k) {
    std::vector<Bytes> parts = {number32("DVID", 1), text("DVNM", device)};
    for (size_t i = 0; i < sensors.size(); ++i) {
      const TestSensor& sensor = sensors[i];
      const double until = ((k + 1) * period_s - sensor.start_s) * sensor.rate_hz;
      const auto taken = static_cast<size_t>(std::max(0.0, std::floor(until / sensor.burst))) * sensor.burst;
      std::vector<int> values;
      const size_t first = next[i];
      for (; next[i] < taken; ++next[i]) {
        const Vec3 value = sensor.stored(sensor.start_s + static_cast<double>(next[i]) / sensor.rate_hz);
        for (int axis = 0; axis < 3; ++axis) {
          values.push_back(static_cast<int>(std::lround(value[axis] * sensor.scale)));
        }
      }
      std::vector<Bytes> stream;
      if (sensor.clock_s) {
        const double stamp_s = *sensor.clock_s + sensor.start_s + static_cast<double>(first) / sensor.rate_hz;
        stream.push_back(number64("STMP", static_cast<uint64_t>(std::llround(stamp_s * 1e6))));
      }
      stream.push_back(number32("TSMP", static_cast<uint32_t>(next[i])));
      if (!sensor.stored_axes.empty()) stream.push_back(text("ORIN", sensor.stored_axes));
      stream.push_back(text("SIUN", sensor.unit));
      stream.push_back(shorts("SCAL", 1, {sensor.scale}));
      stream.push_back(shorts(sensor.key, 3, values));
      parts.push_back(nested("STRM", stream));
    }
    payloads.push_back(nested("DEVC", parts));
  }
  return payloads;
}

}  // namespace lodeline::test
