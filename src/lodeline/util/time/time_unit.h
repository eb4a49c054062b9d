#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lodeline {

/// Unit of a number in a time column. Ticks are steps of 100 ns, as Windows, .NET and some receivers of GPS
/// count them. Ticks beyond the range of a Time count from 1601 (FILETIME) or, above 5e17, from the year 1
/// (.NET); they are converted to Unix time.
enum class TimeUnit { Nanoseconds, Microseconds, Milliseconds, Seconds, Minutes, Hours, Ticks };

/// Units in which devices and programs write stamps, finest first.
inline constexpr std::array<TimeUnit, 5> kStampUnits = {TimeUnit::Nanoseconds, TimeUnit::Ticks,
                                                        TimeUnit::Microseconds, TimeUnit::Milliseconds,
                                                        TimeUnit::Seconds};

constexpr int64_t nanosecondsPer(TimeUnit unit) {
  constexpr int64_t kFactors[] = {1, 1'000, 1'000'000, 1'000'000'000, 60'000'000'000, 3'600'000'000'000, 100};
  return kFactors[static_cast<size_t>(unit)];
}

constexpr double secondsPer(TimeUnit unit) { return 1e-9 * static_cast<double>(nanosecondsPer(unit)); }

/// "ns", "us", "ms", "s", "min", "h", "100 ns".
const char* toString(TimeUnit unit);
/// "nanoseconds", ...
const char* nameOf(TimeUnit unit);

/// The names of kStampUnits, for messages.
std::string knownStampUnits();

/// The unit named by a single word ("us", "µs", "usec", "Microseconds", "100 ns"); nothing for any other
/// text.
std::optional<TimeUnit> timeUnitOfWord(std::string_view word);

/// The unit stated in the name of a column: in brackets ("t [ms]", "time (µs)"), after a slash ("t / s"), or
/// as one of its words ("time_ms", "TimeUS", "timestamp_ns", "seconds_elapsed", "timeusec"). Brackets have
/// priority. Returns nothing where the name states no unit ("timestamp", "time"), or where the brackets hold
/// another word.
std::optional<TimeUnit> timeUnitOfName(std::string_view column);

/// Range of plausible sampling rates of a kind of sensor.
struct PlausibleRate {
  double least_hz;
  double most_hz;
};
inline constexpr PlausibleRate kInertialRate = {10.0, 1e4};
inline constexpr PlausibleRate kMagnetometerRate = {1.0, 1e3};
inline constexpr PlausibleRate kCameraRate = {0.5, 500.0};
/// Dive computers sample every few seconds; logging gauges sample about ten times a second.
inline constexpr PlausibleRate kDepthRate = {1.0 / 120.0, 100.0};

/// Sampling rate in readings per unit of the stamps, computed over the central half of the sorted stamps.
/// Isolated wrong stamps, unordered readings, bursts and equal stamps do not change it. Returns 0 where the
/// rate is undetermined.
double stampsPerUnit(std::vector<double> stamps);

/// The stamp unit for which the rate of `stamps` is within `rate`. Where several units fit, the unit
/// that gives a current Unix time wins. Then any unit comes before ticks, and then the one with the rate
/// nearest to the middle of the range. Returns nothing where no unit fits. A few dozen stamps are
/// enough.
std::optional<TimeUnit> timeUnitOfStamps(const std::vector<double>& stamps, PlausibleRate rate);

/// Whether a stamp, taken for ticks, is a time between 2001 and 2065 since 1601, the year 1, 1970 or 1980,
/// and is not such a Unix time in nanoseconds.
bool isCurrentTimeInTicks(double stamp);

/// Whether stamps without a unit count ticks. Each is then a current time in ticks, and the rate is
/// plausible. As nanoseconds the stamps are neither a current time nor those of a usual sensor.
bool areTicks(const std::vector<double>& stamps, PlausibleRate rate);

/// Converts a decimal number in `unit` to nanoseconds, rounded to the nearest nanosecond. The conversion is
/// exact: "1403636579.763555584" in seconds keeps all its digits. Returns nothing for any other text and for
/// times outside 64 bits.
std::optional<int64_t> parseTime_ns(std::string_view text, TimeUnit unit);

}  // namespace lodeline
