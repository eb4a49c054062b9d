#include "lodeline/estimator/pressure/gauge_scale_check.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "lodeline/util/median.h"

namespace lodeline {
namespace {

// Readings accurate to 3 cm give slopes to a fifth; the median of seven gives a tenth.
constexpr double kStretch_m = 0.2;
constexpr double kLongest_s = 10.0;  // for one section, because the estimate drifts
constexpr size_t kEnough = 7;
constexpr size_t kKept = 15;

struct KnownSlope {
  double slope;
  const char* meaning;
};
constexpr KnownSlope kKnown[] = {{1000.0, "in mm"},
                                 {100.0, "in cm or mbar"},
                                 {9806.65, "in Pa"},
                                 {9.80665, "in kPa"},
                                 {3.2808, "in feet"},
                                 {1.4223, "in psi"},
                                 {0.0980665, "in bar"},
                                 {-1.0, "heights: positive up, not down"},
                                 {0.0, "those of a port that is blocked or a sensor that has stopped"}};

}  // namespace

void GaugeScaleCheck::add(Time time, double depth, double rise_m) {
  rise_since_mark_m_ += rise_m;
  const bool far = std::abs(rise_since_mark_m_) >= kStretch_m;
  if (mark_ && !far && (time - mark_->time).seconds() < kLongest_s) return;
  if (mark_ && far) {
    slopes_.push_back((mark_->depth - depth) / rise_since_mark_m_);
    if (slopes_.size() > kKept) slopes_.pop_front();
  }
  mark_ = Mark{time, depth};
  rise_since_mark_m_ = 0.0;
}

std::optional<double> GaugeScaleCheck::slope() const {
  if (slopes_.size() < kEnough) return std::nullopt;
  return median(std::vector<double>(slopes_.begin(), slopes_.end()));
}

std::string explainSlope(double slope) {
  for (const KnownSlope& known : kKnown) {
    if (std::abs(slope - known.slope) <= std::max(0.05, 0.2 * std::abs(known.slope)))
      return fmt::format("readings seem to be {}", known.meaning);
  }
  return "is the column depth in m?";
}

}  // namespace lodeline
