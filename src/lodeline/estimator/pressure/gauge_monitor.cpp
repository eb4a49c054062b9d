#include "lodeline/estimator/pressure/gauge_monitor.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lodeline/util/median.h"

namespace lodeline {
namespace {

constexpr double kFrozenRise_m = 0.1;
constexpr double kFrozenSpan_s = 10.0;
constexpr size_t kScatterReadings = 21;

}  // namespace

DepthStatus GaugeMonitor::check(const DepthSample& reading, const VerticalMotion& motion, double lag_s,
                                bool is_reliable) {
  if (!changed_ || reading.depth_m != changed_->depth_m) {
    changed_ = reading;
    is_frozen_ = false;
  }
  if (is_reliable && last_) {
    slope_.add(reading.time, reading.depth_m, motion.shownRise(last_->time, reading.time, lag_s));
    const Time since = std::max(changed_->time, reading.time - Duration::fromSeconds(kFrozenSpan_s));
    const double rise_m = motion.shownRise(since, reading.time, lag_s);
    is_frozen_ = is_frozen_ || std::abs(rise_m) > kFrozenRise_m + 3.0 * readingSigma();
  } else {
    slope_.interrupt();
  }
  last_ = reading;
  const std::optional<double> slope = slope_.slope();
  if (slope && (*slope < options_.least_slope || *slope > options_.greatest_slope)) return DepthStatus::Slope;
  return is_frozen_ ? DepthStatus::Frozen : DepthStatus::Used;
}

void GaugeMonitor::learnScatter(const std::optional<double>& innovation_m) {
  if (innovation_m && last_innovation_m_) {
    differences_m_.push_back(std::abs(*innovation_m - *last_innovation_m_));
    if (differences_m_.size() > kScatterReadings) differences_m_.pop_front();
  }
  last_innovation_m_ = innovation_m;
}

double GaugeMonitor::readingSigma() const {
  if (differences_m_.size() < kScatterReadings) return stated_sigma_m_;
  // The scatter comes from differences of successive innovations, so that constant errors do not count. It
  // uses their median, so that spikes do not count.
  constexpr double kMedianOfNormal = 0.6745;
  const double usual_m = median(std::vector<double>(differences_m_.begin(), differences_m_.end()));
  return std::max(stated_sigma_m_, usual_m / (kMedianOfNormal * std::sqrt(2.0)));
}

}  // namespace lodeline
