#include "lodeline/util/time/time_unit.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <tuple>

#include "lodeline/util/csv_fields.h"

namespace lodeline {
namespace {

struct Word {
  std::string_view text;  ///< lower case
  TimeUnit unit;
};

constexpr std::array kWords = {Word{"ns", TimeUnit::Nanoseconds},
                               Word{"nsec", TimeUnit::Nanoseconds},
                               Word{"nsecs", TimeUnit::Nanoseconds},
                               Word{"nanos", TimeUnit::Nanoseconds},
                               Word{"nanosec", TimeUnit::Nanoseconds},
                               Word{"nanosecs", TimeUnit::Nanoseconds},
                               Word{"nanosecond", TimeUnit::Nanoseconds},
                               Word{"nanoseconds", TimeUnit::Nanoseconds},
                               Word{"us", TimeUnit::Microseconds},
                               Word{"usec", TimeUnit::Microseconds},
                               Word{"usecs", TimeUnit::Microseconds},
                               Word{"micros", TimeUnit::Microseconds},
                               Word{"microsec", TimeUnit::Microseconds},
                               Word{"microsecs", TimeUnit::Microseconds},
                               Word{"microsecond", TimeUnit::Microseconds},
                               Word{"microseconds", TimeUnit::Microseconds},
                               Word{"ms", TimeUnit::Milliseconds},
                               Word{"msec", TimeUnit::Milliseconds},
                               Word{"msecs", TimeUnit::Milliseconds},
                               Word{"millis", TimeUnit::Milliseconds},
                               Word{"millisec", TimeUnit::Milliseconds},
                               Word{"millisecs", TimeUnit::Milliseconds},
                               Word{"millisecond", TimeUnit::Milliseconds},
                               Word{"milliseconds", TimeUnit::Milliseconds},
                               Word{"s", TimeUnit::Seconds},
                               Word{"sec", TimeUnit::Seconds},
                               Word{"secs", TimeUnit::Seconds},
                               Word{"second", TimeUnit::Seconds},
                               Word{"seconds", TimeUnit::Seconds},
                               Word{"min", TimeUnit::Minutes},
                               Word{"mins", TimeUnit::Minutes},
                               Word{"minute", TimeUnit::Minutes},
                               Word{"minutes", TimeUnit::Minutes},
                               Word{"h", TimeUnit::Hours},
                               Word{"hr", TimeUnit::Hours},
                               Word{"hrs", TimeUnit::Hours},
                               Word{"hour", TimeUnit::Hours},
                               Word{"hours", TimeUnit::Hours},
                               Word{"100ns", TimeUnit::Ticks},
                               Word{"100 ns", TimeUnit::Ticks},
                               Word{"0.1us", TimeUnit::Ticks},
                               Word{"0.1 us", TimeUnit::Ticks}};

/// Ticks from this number on count from 1601, and from the second one on from the year 1. A Time in ticks
/// since 1970 ends before the first.
constexpr double kFirstFileTime = 9.3e16, kFirstDotNetTicks = 5e17;
/// Seconds from these epochs to 1970 (Microsoft, FILETIME structure and DateTime.Ticks).
constexpr int64_t kSecondsSince1601 = 11'644'473'600, kSecondsSinceYear1 = 62'135'596'800;

/// Seconds from the epoch of a number of ticks to 1970.
int64_t epochOfTicks_s(double ticks) {
  if (ticks >= kFirstDotNetTicks) return kSecondsSinceYear1;
  return ticks >= kFirstFileTime ? kSecondsSince1601 : 0;
}

bool isLetter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }
bool isUpper(char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }

/// `text` with both Unicode micro characters replaced by the letter u.
std::string withLatinMicro(std::string_view text) {
  std::string result;
  for (size_t i = 0; i < text.size(); ++i) {
    const std::string_view two = text.substr(i, 2);
    const bool is_micro = two == "\u00b5" || two == "\u03bc";
    if (is_micro) ++i;
    result += is_micro ? 'u' : text[i];
  }
  return result;
}

/// Splits a name into runs of letters, also between a small letter and a capital: "TimeUS" has "Time" and
/// "US".
std::vector<std::string> wordsOf(std::string_view name) {
  std::vector<std::string> words;
  char before = ' ';
  for (const char c : name) {
    if (isLetter(c)) {
      if (!isLetter(before) || (isUpper(c) && !isUpper(before))) words.emplace_back();
      words.back() += c;
    }
    before = c;
  }
  return words;
}

/// The unit in a word that joins it to a word for time, as in "timems" or "timestampus". The unit must have
/// two letters or more.
std::optional<TimeUnit> unitWithin(std::string word) {
  std::transform(word.begin(), word.end(), word.begin(), [](unsigned char c) { return std::tolower(c); });
  for (const std::string_view time : {"timestamp", "stamp", "time"}) {
    if (!word.starts_with(time) || word.size() < time.size() + 2) continue;
    return timeUnitOfWord(std::string_view(word).substr(time.size()));
  }
  return std::nullopt;
}

/// Whether `stamp` in `unit` is a Unix time between 2001 and 2065.
bool isUnixTime(double stamp, TimeUnit unit) {
  double seconds = std::abs(stamp) * secondsPer(unit);
  if (unit == TimeUnit::Ticks) seconds -= static_cast<double>(epochOfTicks_s(stamp));
  return seconds > 1e9 && seconds < 3e9;
}

/// Whether readings of that rate can be of a sensor. The tolerance is for real rates, which differ from
/// nominal ones: a 10 Hz sensor often has 9.9 Hz.
bool isPlausible(double rate_hz, PlausibleRate rate) {
  return rate_hz >= 0.8 * rate.least_hz && rate_hz <= 1.25 * rate.most_hz;
}

}  // namespace

const char* toString(TimeUnit unit) {
  constexpr const char* kTexts[] = {"ns", "us", "ms", "s", "min", "h", "100 ns"};
  return kTexts[static_cast<size_t>(unit)];
}

const char* nameOf(TimeUnit unit) {
  constexpr const char* kTexts[] = {"nanoseconds", "microseconds", "milliseconds",   "seconds",
                                    "minutes",     "hours",        "steps of 100 ns"};
  return kTexts[static_cast<size_t>(unit)];
}

std::string knownStampUnits() {
  std::string names;
  for (const TimeUnit unit : kStampUnits) names += (names.empty() ? "" : ", ") + std::string(toString(unit));
  return names;
}

std::optional<TimeUnit> timeUnitOfWord(std::string_view word) {
  std::string lower = withLatinMicro(csv::trimmed(word));
  std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
  for (const Word& known : kWords) {
    if (known.text == lower) return known.unit;
  }
  return std::nullopt;
}

std::optional<TimeUnit> timeUnitOfName(std::string_view column) {
  const size_t open = column.find_first_of("[(");
  if (open != std::string_view::npos) {
    const size_t close = column.find_first_of("])", open);
    return timeUnitOfWord(
        column.substr(open + 1, close == std::string_view::npos ? close : close - open - 1));
  }
  const std::string name = withLatinMicro(column);
  if (name.find("100ns") != std::string::npos || name.find("100_ns") != std::string::npos)
    return TimeUnit::Ticks;
  if (const size_t stroke = name.find_last_of('/'); stroke != std::string::npos) {
    if (const auto unit = timeUnitOfWord(std::string_view(name).substr(stroke + 1))) return unit;
  }
  const std::vector<std::string> words = wordsOf(name);
  for (auto word = words.rbegin(); word != words.rend(); ++word) {
    if (const auto unit = timeUnitOfWord(*word)) return unit;
    if (const auto unit = unitWithin(*word)) return unit;
  }
  return std::nullopt;
}

double stampsPerUnit(std::vector<double> stamps) {
  std::erase_if(stamps, [](double stamp) { return !std::isfinite(stamp); });
  if (stamps.size() < 2) return 0.0;
  std::sort(stamps.begin(), stamps.end());
  const size_t margin = stamps.size() / 4;
  const size_t last = stamps.size() - 1 - margin;
  const double span = stamps[last] - stamps[margin];
  return span > 0.0 ? static_cast<double>(last - margin) / span : 0.0;
}

std::optional<TimeUnit> timeUnitOfStamps(const std::vector<double>& stamps, PlausibleRate rate) {
  const double per_unit = stampsPerUnit(stamps);
  if (!(per_unit > 0.0)) return std::nullopt;
  const double middle = 0.5 * std::log(rate.least_hz * rate.most_hz);
  std::optional<TimeUnit> best;
  auto best_rank = std::tuple(true, true, 0.0);
  for (const TimeUnit unit : kStampUnits) {
    const double rate_hz = per_unit / secondsPer(unit);
    if (!isPlausible(rate_hz, rate)) continue;
    const auto rank = std::tuple(!isUnixTime(stamps.front(), unit), unit == TimeUnit::Ticks,
                                 std::abs(std::log(rate_hz) - middle));
    if (best && !(rank < best_rank)) continue;
    best = unit;
    best_rank = rank;
  }
  return best;
}

bool isCurrentTimeInTicks(double stamp) {
  return isUnixTime(stamp, TimeUnit::Ticks) && !isUnixTime(stamp, TimeUnit::Nanoseconds);
}

bool areTicks(const std::vector<double>& stamps, PlausibleRate rate) {
  const double per_unit = stampsPerUnit(stamps);
  if (!(per_unit > 0.0) || !std::all_of(stamps.begin(), stamps.end(), isCurrentTimeInTicks)) return false;
  if (!isPlausible(per_unit / secondsPer(TimeUnit::Ticks), rate)) return false;
  // Ticks since 1970 or 1980 are also nanoseconds since a device was switched on some months ago.
  constexpr double kUnusual = 0.4;
  return epochOfTicks_s(stamps.front()) != 0 ||
         per_unit / secondsPer(TimeUnit::Nanoseconds) > kUnusual * rate.most_hz;
}

std::optional<int64_t> parseTime_ns(std::string_view text, TimeUnit unit) {
  const bool is_negative = text.starts_with('-');
  if (is_negative || text.starts_with('+')) text.remove_prefix(1);
  const size_t point = std::min(text.find('.'), text.size());
  const std::string_view whole = text.substr(0, point);
  const std::string_view digits = point < text.size() ? text.substr(point + 1) : std::string_view();
  const auto areDigits = [](std::string_view part) {
    return std::all_of(part.begin(), part.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
  };
  if (!areDigits(whole) || !areDigits(digits) || (whole.empty() && digits.empty())) {
    double number = 0.0;  // may have an exponent
    if (text.starts_with('-') || !csv::parse(text, &number)) return std::nullopt;
    // A double resolves current Unix times to 0.2 us only; a long double resolves less than a nanosecond.
    const std::string digits_of_text(text);
    const long double count = std::strtold(digits_of_text.c_str(), nullptr);
    long double ns = count * static_cast<long double>(nanosecondsPer(unit));
    if (unit == TimeUnit::Ticks)
      ns -= 1e9L * static_cast<long double>(epochOfTicks_s(static_cast<double>(count)));
    if (!(std::abs(ns) < 9.2e18L)) return std::nullopt;
    return (is_negative ? -1 : 1) * std::llround(ns);
  }
  // Nanoseconds are a signed 64-bit number whose minimum has no positive counterpart.
  __extension__ using Wide = __int128;
  Wide value = 0;
  constexpr Wide kMost = Wide{std::numeric_limits<int64_t>::max()} + 1;
  for (const char digit : whole) {
    value = 10 * value + (digit - '0');
    if (value > kMost) return std::nullopt;
  }
  const Wide epoch_s = unit == TimeUnit::Ticks ? epochOfTicks_s(static_cast<double>(value)) : 0;
  value = value * nanosecondsPer(unit) - epoch_s * nanosecondsPer(TimeUnit::Seconds);
  Wide place = nanosecondsPer(unit);
  Wide scaled = 0;  // the first kMostDecimals decimals as an integer
  constexpr size_t kMostDecimals = 15;
  Wide denominator = 1;
  for (const char digit : digits.substr(0, kMostDecimals)) {
    scaled = 10 * scaled + (digit - '0');
    denominator *= 10;
  }
  value += (2 * scaled * place + denominator) / (2 * denominator);
  if (is_negative) value = -value;
  if (value > kMost - 1 || value < -kMost) return std::nullopt;
  return static_cast<int64_t>(value);
}

}  // namespace lodeline
