#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace lodeline {

/// What a number in a column of times counts.
enum class TimeUnit { Nanoseconds, Microseconds, Milliseconds, Seconds, Minutes, Hours };

/// The units in which devices and programs write stamps, finest first.
inline constexpr std::array<TimeUnit, 4> kStampUnits = {TimeUnit::Nanoseconds, TimeUnit::Microseconds,
                                                        TimeUnit::Milliseconds, TimeUnit::Seconds};

constexpr int64_t nanosecondsPer(TimeUnit unit) {
  constexpr int64_t kFactors[] = {1, 1'000, 1'000'000, 1'000'000'000, 60'000'000'000, 3'600'000'000'000};
  return kFactors[static_cast<size_t>(unit)];
}

constexpr double secondsPer(TimeUnit unit) { return 1e-9 * static_cast<double>(nanosecondsPer(unit)); }

/// "ns", "us", "ms", "s", "min", "h".
const char* toString(TimeUnit unit);
/// "nanoseconds", ...
const char* nameOf(TimeUnit unit);

/// The unit that a bare word names ("us", "µs", "usec", "Microseconds"); nothing for any other text.
std::optional<TimeUnit> timeUnitOfWord(std::string_view word);

/// The unit that the name of a column states: in brackets ("t [ms]", "time (µs)"), after a stroke ("t / s"),
/// or as one of its words ("time_ms", "TimeUS", "timestamp_ns", "seconds_elapsed", "timeusec"). Brackets
/// decide. Nothing where the name states none ("timestamp", "time"), or where the brackets hold another word.
std::optional<TimeUnit> timeUnitOfName(std::string_view column);

/// How often a sensor of a kind can measure.
struct PlausibleRate {
  double least_hz;
  double most_hz;
};
inline constexpr PlausibleRate kInertialRate = {10.0, 1e4};
inline constexpr PlausibleRate kMagnetometerRate = {1.0, 1e3};
inline constexpr PlausibleRate kCameraRate = {0.5, 500.0};
/// Dive computers sample every few seconds, logging gauges some ten times a second.
inline constexpr PlausibleRate kDepthRate = {1.0 / 120.0, 100.0};

/// Readings per unit of the stamps: over the central half of the sorted stamps. Single wild stamps, readings
/// in another order, bursts and equal stamps do not move it. 0 where it cannot be told.
double stampsPerUnit(std::vector<double> stamps);

/// The unit in which the rate of `stamps` is one that the sensor can have. Where several units pass, today's
/// size of a Unix time decides, then the rate nearest to the middle of the range. Nothing where none passes.
/// A few dozen stamps do.
std::optional<TimeUnit> timeUnitOfStamps(const std::vector<double>& stamps, PlausibleRate rate);

/// Nanoseconds of a number with or without decimals, exactly: "1403636579.763555584" in seconds keeps all its
/// digits. Rounds to the nearest nanosecond. Nothing for any other text, and for times that 64 bits cannot
/// hold.
std::optional<int64_t> parseTime_ns(std::string_view text, TimeUnit unit);

}  // namespace lodeline
