#include "lodeline/magnetometer/iron/reading_screen.h"

#include <fmt/core.h>

#include <algorithm>

namespace lodeline {
namespace {

constexpr double kFrozen_s = 2.0;
/// Thresholds for saturation: minimum count of the extreme value, and its ratio to the count of all values
/// within the next fiftieth of the extent.
constexpr int kFewestSaturated = 10;
constexpr double kSaturatedFactor = 3.0;
constexpr double kNear = 0.02;

/// Whether the largest of the sorted values is the end of the range.
bool endsSaturated(const std::vector<double>& sorted) {
  const double greatest = sorted.back();
  const double near = greatest - kNear * (greatest - sorted.front());
  const auto first_near = std::lower_bound(sorted.begin(), sorted.end(), near);
  const auto first_greatest = std::lower_bound(sorted.begin(), sorted.end(), greatest);
  const auto at_end = sorted.end() - first_greatest;
  // Coarse counts: compares with the next value where the last fiftieth has no other one.
  auto beside = first_greatest - first_near;
  if (beside == 0 && first_greatest != sorted.begin()) {
    const double next = *(first_greatest - 1);
    beside = first_greatest - std::lower_bound(sorted.begin(), first_greatest, next);
  }
  return at_end >= kFewestSaturated &&
         static_cast<double>(at_end) >
             kSaturatedFactor * static_cast<double>(std::max<std::ptrdiff_t>(1, beside));
}

/// Removes readings at the ends of a saturated axis; returns their number.
int removeSaturated(std::vector<MagnetometerSample>* samples) {
  std::vector<bool> bad(samples->size(), false);
  for (int axis = 0; axis < 3 && !samples->empty(); ++axis) {
    for (const double sign : {1.0, -1.0}) {
      std::vector<double> values;
      for (const MagnetometerSample& sample : *samples) values.push_back(sign * sample.field_M[axis]);
      std::sort(values.begin(), values.end());
      if (values.front() == values.back() || !endsSaturated(values)) continue;
      for (size_t i = 0; i < samples->size(); ++i) {
        if (sign * (*samples)[i].field_M[axis] == values.back()) bad[i] = true;
      }
    }
  }
  std::vector<MagnetometerSample> good;
  for (size_t i = 0; i < samples->size(); ++i) {
    if (!bad[i]) good.push_back((*samples)[i]);
  }
  const int removed = static_cast<int>(samples->size() - good.size());
  *samples = std::move(good);
  return removed;
}

void reportScreen(const ReadingScreen& screen, size_t total, Diagnostics* diagnostics) {
  const auto report = [&](int count, Severity severity, const char* kind, const char* what) {
    if (count == 0) return;
    diagnostics->report(severity, kind, fmt::format("{} of {} magnetometer readings {}", count, total, what));
  };
  report(screen.repeated, Severity::Notice, "magnetometer_repeated", "repeat the one before; passed over");
  report(screen.not_finite, Severity::Warning, "magnetometer_not_finite", "are no numbers; passed over");
  report(screen.disordered, Severity::Warning, "magnetometer_disordered",
         "are not later than the one before; passed over");
  report(
      screen.saturated, Severity::Warning, "magnetometer_saturated",
      "lie at the end of the sensor's range; passed over. A magnet is near, or the range is set too narrow");
  if (screen.longest_frozen_s >= kFrozen_s) {
    diagnostics->report(
        Severity::Warning, "magnetometer_frozen",
        fmt::format("the magnetometer was frozen for {:.1f} s: the same reading over and over",
                    screen.longest_frozen_s));
  }
}

}  // namespace

ReadingScreen screenReadings(std::span<const MagnetometerSample> samples, Diagnostics* diagnostics) {
  ReadingScreen screen;
  Time frozen_since;
  for (const MagnetometerSample& sample : samples) {
    const MagnetometerSample* before = screen.usable.empty() ? nullptr : &screen.usable.back();
    if (!sample.field_M.allFinite()) {
      ++screen.not_finite;
    } else if (before != nullptr && sample.time <= before->time) {
      ++screen.disordered;
    } else if (before != nullptr && sample.field_M == before->field_M) {
      ++screen.repeated;
      screen.longest_frozen_s = std::max(screen.longest_frozen_s, (sample.time - frozen_since).seconds());
    } else {
      frozen_since = sample.time;
      screen.usable.push_back(sample);
    }
  }
  screen.saturated = removeSaturated(&screen.usable);
  reportScreen(screen, samples.size(), diagnostics);
  return screen;
}

}  // namespace lodeline
