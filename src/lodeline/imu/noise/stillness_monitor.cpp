#include "lodeline/imu/noise/stillness_monitor.h"

#include <algorithm>
#include <cmath>

#include "lodeline/util/median.h"

namespace lodeline {
namespace {

constexpr double kStretch_s = 10.0;
constexpr double kUnusualScatter = 3.0;  ///< multiple of the median window's
constexpr int kFewestInAMean = 4;

}  // namespace

void StillnessMonitor::add(Time time, const Vec3& reading) {
  if (begin_ && (time - *begin_).seconds() >= kStretch_s) close();
  if (!begin_) {
    begin_ = time;
    origin_ = reading;
  }
  const Vec3 offset = reading - origin_;
  sum_ += offset;
  squares_ += offset.cwiseAbs2();
  ++count_;
}

void StillnessMonitor::close() {
  if (count_ >= kFewestInAMean) {
    const Vec3 mean_offset = sum_ / count_;
    const double variance = (squares_ / count_ - mean_offset.cwiseAbs2()).cwiseMax(0.0).mean();
    const Vec3 mean = origin_ + mean_offset;
    const double step = last_mean_ ? (mean - *last_mean_).norm() : 0.0;
    windows_.push_back({*begin_, static_cast<float>(std::sqrt(variance)), static_cast<float>(step)});
    last_mean_ = mean;
  }
  begin_.reset();
  sum_.setZero();
  squares_.setZero();
  count_ = 0;
}

Stillness StillnessMonitor::result() const {
  Stillness result;
  result.windows = static_cast<int>(windows_.size());
  if (windows_.empty()) return result;
  std::vector<float> scatter;
  for (const Window& window : windows_) scatter.push_back(window.std);
  result.median_std = median(std::move(scatter));
  const double limit = std::min(limits_.largest_std, kUnusualScatter * result.median_std);
  for (const Window& window : windows_) {
    // A sensor without noise has a median of zero, which gives no limit.
    const bool scatters = window.std > (result.median_std > 0.0 ? limit : limits_.largest_std);
    if (!scatters && window.step <= limits_.largest_step) continue;
    if (!result.first_moved) result.first_moved = window.begin;
    ++result.moved;
  }
  return result;
}

}  // namespace lodeline
