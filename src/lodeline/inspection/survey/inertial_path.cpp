#include "lodeline/inspection/survey/inertial_path.h"

#include <algorithm>

#include "lodeline/geometry/so3.h"
#include "lodeline/util/median.h"

namespace lodeline {

InertialPath::InertialPath(const std::vector<ImuSample>& imu, const Vec3& gyroscope_bias_B) {
  Quat attitude = Quat::Identity();
  Vec3 integral = Vec3::Zero();
  for (size_t i = 0; i < imu.size(); ++i) {
    if (i > 0) {
      const double step_s = (imu[i].time - imu[i - 1].time).seconds();
      const Vec3 rate = 0.5 * (imu[i].angular_velocity_B + imu[i - 1].angular_velocity_B) - gyroscope_bias_B;
      const Vec3 force = 0.5 * (imu[i].specific_force_B + imu[i - 1].specific_force_B);
      integral += step_s * (attitude * (so3::exp(0.5 * step_s * rate) * force));
      attitude = (attitude * so3::exp(step_s * rate)).normalized();
    }
    times_.push_back(imu[i].time);
    attitudes_.push_back(attitude);
    force_integrals_.push_back(integral);
    rates_B_.push_back(imu[i].angular_velocity_B - gyroscope_bias_B);
  }
}

std::optional<InertialPath::Place> InertialPath::find(Time time) const {
  const auto after = std::lower_bound(times_.begin(), times_.end(), time);
  if (after == times_.end() || after == times_.begin()) return std::nullopt;
  const auto i = static_cast<size_t>(after - times_.begin());
  return Place{i, (time - times_[i - 1]).seconds() / (times_[i] - times_[i - 1]).seconds()};
}

std::optional<Mat3> InertialPath::attitude(Time time) const {
  const std::optional<Place> place = find(time);
  if (!place) return std::nullopt;
  return attitudes_[place->after - 1].slerp(place->share, attitudes_[place->after]).toRotationMatrix();
}

std::optional<Vec3> InertialPath::forceIntegral(Time time) const {
  const std::optional<Place> place = find(time);
  if (!place) return std::nullopt;
  const Vec3 &before = force_integrals_[place->after - 1], &after = force_integrals_[place->after];
  return Vec3(before + place->share * (after - before));
}

std::optional<Vec3> InertialPath::rate_B(Time time) const {
  const std::optional<Place> place = find(time);
  if (!place) return std::nullopt;
  const Vec3 &before = rates_B_[place->after - 1], &after = rates_B_[place->after];
  return Vec3(before + place->share * (after - before));
}

Vec3 medianRate_B(const std::vector<ImuSample>& imu) {
  Vec3 result;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> values;
    for (const ImuSample& sample : imu) values.push_back(sample.angular_velocity_B[axis]);
    result[axis] = median(values);
  }
  // The bias at switch-on is small; a larger mean is a long rotation.
  constexpr double kLargestBias_rad_per_s = 0.1;
  return result.norm() < kLargestBias_rad_per_s ? result : Vec3::Zero();
}

}  // namespace lodeline
