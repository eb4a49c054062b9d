#include "lodeline/io/streams/saturation_detector.h"

#include <algorithm>
#include <cmath>

namespace lodeline {

bool SaturationDetector::End::add(double before, double reading, const Axis& axis) {
  constexpr int kPlateaus = 3, kLongStay = 10;
  constexpr double kAway = 0.1, kSteps = 3.0, kWide = 20.0, kFine = 2.0;
  if (reading > value) {
    *this = End();
    value = reading;
  }
  away = std::max(away, value - reading);
  if (reading < value) {
    stay = 0;
    return false;
  }
  if (++stay == 1) step = std::abs(reading - before);
  const double range = axis.greatest - axis.least;
  if (range < kWide * axis.resolution) return false;
  const bool is_steep = step > kSteps * axis.resolution;
  if (stay == 2 && is_steep && (away > kAway * range || plateaus == 0)) {
    ++plateaus;
    away = 0.0;
  }
  if (stay >= kLongStay && axis.change > kFine * axis.resolution) plateaus = kPlateaus;
  return plateaus >= kPlateaus;
}

bool SaturationDetector::Axis::add(double reading) {
  if (!begun) {
    begun = true;
    before = least = greatest = reading;
  }
  if (reading != before) resolution = std::min(resolution, std::abs(reading - before));
  least = std::min(least, reading);
  greatest = std::max(greatest, reading);
  constexpr double kOf = 0.03;
  if (reading != before) change += kOf * (std::abs(reading - before) - change);
  const bool at_upper = upper.add(before, reading, *this);
  const bool at_lower = lower.add(-before, -reading, *this);
  before = reading;
  return at_upper || at_lower;
}

bool SaturationDetector::isSaturated(const ImuSample& sample) {
  bool result = false;
  for (size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    result |= axes_[i].add(sample.angular_velocity_B[axis]);
    result |= axes_[3 + i].add(sample.specific_force_B[axis]);
  }
  return result;
}

}  // namespace lodeline
