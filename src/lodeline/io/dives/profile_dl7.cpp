#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string_view>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/io/dives/profile_rows.h"
#include "lodeline/io/dives/profile_time.h"
#include "lodeline/io/tables/cells.h"
#include "lodeline/io/tables/text_lines.h"

namespace lodeline {
namespace {

constexpr double kSecondsPerMinute = 60.0;

/// The fields of a segment: "ZDH|1|2|I|V|20180102101000" has the name "ZDH" as
/// field 0.
std::vector<std::string_view> fieldsOf(std::string_view line) {
  std::vector<std::string_view> fields;
  while (true) {
    const size_t bar = line.find('|');
    fields.push_back(trimmed(line.substr(0, bar)));
    if (bar == std::string_view::npos) return fields;
    line.remove_prefix(bar + 1);
  }
}

std::string fieldAt(const std::vector<std::string_view>& fields, size_t index) {
  return index < fields.size() ? std::string(fields[index]) : std::string();
}

/// "YYYYMMDDhhmmss" as "YYYY-MM-DD hh:mm:ss"; empty for any other text.
std::string dateOf(const std::string& digits) {
  constexpr size_t kDigits = 14;
  if (digits.size() < kDigits || !std::all_of(digits.begin(), digits.begin() + kDigits, isDigit)) return "";
  return profileStart(digits.substr(0, 4) + "-" + digits.substr(4, 2) + "-" + digits.substr(6, 2) + " " +
                      digits.substr(8, 2) + ":" + digits.substr(10, 2) + ":" + digits.substr(12, 2));
}

/// Metres per unit of depth: MSWG, MFWG, FSWG, FFWG (metres or feet of sea or
/// fresh water, gauge).
std::optional<double> metresPer(std::string unit) {
  std::transform(unit.begin(), unit.end(), unit.begin(), [](unsigned char c) { return std::toupper(c); });
  if (unit == "MSWG" || unit == "MFWG" || unit == "M") return 1.0;
  if (unit == "FSWG" || unit == "FFWG" || unit == "FT") return 0.3048;
  return std::nullopt;
}

/// Reads the segments line by line.
class Dl7Log {
 public:
  Dl7Log(std::string name, Diagnostics* diagnostics) : name_(std::move(name)), diagnostics_(diagnostics) {
    log_.has_stated_dives = true;
  }

  void take(std::string_view line, int number) {
    const std::vector<std::string_view> fields = fieldsOf(line);
    const std::string_view segment = fields[0];
    if (is_profile_ && !segment.starts_with("ZDP}")) {
      if (!trimmed(line).empty()) takeRow(fields, number);
    } else if (segment == "ZRH") {
      unit_ = fieldAt(fields, 4);
      log_.metres_per_unit = metresPer(unit_);
    } else if (segment == "ZDH") {
      settleTimes();
      log_.dives.push_back({fieldAt(fields, 2), dateOf(fieldAt(fields, 5))});
      first_row_ = log_.rows.size();
      has_decimals_ = false;
    } else if (segment.starts_with("ZDP{") || segment.starts_with("ZDP}")) {
      is_profile_ = segment.starts_with("ZDP{");
    } else if (segment == "ZDT") {
      end_ = dateOf(fieldAt(fields, 4));
      settleTimes();
    }
  }

  ProfileRows finish() {
    settleTimes();
    if (log_.rows.empty()) throw InputError(name_ + ": a dive log without a depth profile");
    if (!log_.metres_per_unit) {
      throw InputError(
          fmt::format("{}: the log states depths in '{}', which "
                      "is no known unit (MSWG, MFWG, FSWG, "
                      "FFWG)",
                      name_, unit_));
    }
    return std::move(log_);
  }

 private:
  void takeRow(const std::vector<std::string_view>& fields, int number) {
    if (log_.dives.empty()) throw InputError(fmt::format("{}:{}: a profile without a dive", name_, number));
    const std::string time = fieldAt(fields, 1);
    const std::optional<double> minutes = numberFrom(time), depth = numberFrom(fieldAt(fields, 2));
    if (!minutes || !depth || !std::isfinite(*minutes) || !std::isfinite(*depth)) {
      throw InputError(fmt::format("{}:{}: '{}' is no row of time and depth", name_, number,
                                   excerpt(time + "|" + fieldAt(fields, 2))));
    }
    has_decimals_ = has_decimals_ || time.find_first_of(".,") != std::string::npos;
    log_.rows.push_back({*minutes, *depth, static_cast<int>(log_.dives.size()), number});
  }

  /// Converts the times of the last dive. The standard has minutes; some
  /// programs write whole seconds. The stated end of the dive decides, else the
  /// decimals.
  void settleTimes() {
    if (first_row_ >= log_.rows.size()) return;
    const double last = log_.rows.back().time_s;
    const std::optional<double> begin = parseProfileTime(log_.dives.back().start),
                                end = parseProfileTime(end_);
    bool are_seconds = !has_decimals_;
    if (begin && end && *end > *begin && last > 0.0) {
      const double stated_s = *end - *begin;
      are_seconds =
          std::abs(std::log(last / stated_s)) < std::abs(std::log(kSecondsPerMinute * last / stated_s));
    }
    for (size_t i = first_row_; i < log_.rows.size(); ++i)
      log_.rows[i].time_s *= are_seconds ? 1.0 : kSecondsPerMinute;
    if (are_seconds) {
      diagnostics_->report(Severity::Notice, "profile_time",
                           fmt::format("{}: the times of dive {} are taken for seconds; the "
                                       "standard of DL7 has "
                                       "minutes, in which the dive would last {:.0f} hours",
                                       name_, log_.dives.back().number, last / kSecondsPerMinute));
    }
    first_row_ = log_.rows.size();
    end_.clear();
  }

  std::string name_;
  Diagnostics* diagnostics_;
  ProfileRows log_;
  std::string unit_ = "no unit";
  std::string end_;       ///< of the last dive, as stated
  size_t first_row_ = 0;  ///< of the last dive
  bool has_decimals_ = false;
  bool is_profile_ = false;
};

}  // namespace

std::optional<ProfileRows> readProfileDl7(const std::string& text, const std::string& name,
                                          Diagnostics* diagnostics) {
  if (!text.starts_with("FSH|") && !text.starts_with("ZRH|")) return std::nullopt;
  TextLines lines(bytesInMemory(text), name);
  Dl7Log log(name, diagnostics);
  for (std::string_view line; lines.next(&line);) log.take(line, lines.number());
  return log.finish();
}

}  // namespace lodeline
