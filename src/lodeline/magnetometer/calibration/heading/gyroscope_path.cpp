#include "lodeline/magnetometer/calibration/heading/gyroscope_path.h"

#include <algorithm>

#include "lodeline/imu/rotation_increment.h"
#include "lodeline/imu/sample_check.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

constexpr double kGapSteps = 4.0;

GyroscopePath::Point advanced(const GyroscopePath::Point& from, const Vec3& rate_B, double step_s) {
  const RotationIncrement step(from.rate_B, rate_B, step_s);
  const Quat turn = so3::exp(step.rotation_vector);
  GyroscopePath::Point to;
  to.start_from_body = (from.start_from_body * turn).normalized();
  to.by_bias = turn.toRotationMatrix().transpose() * from.by_bias +
               so3::rightJacobian(step.rotation_vector) * step.by_bias;
  to.rate_B = rate_B;
  return to;
}

}  // namespace

GyroscopePath::GyroscopePath(std::span<const ImuSample> samples, const Vec3& gyroscope_bias_B)
    : samples_(samples), bias_(gyroscope_bias_B) {
  requireUsable(samples);
  const double usual_s = medianStep_s(samples);
  points_.reserve(samples.size());
  points_.emplace_back();
  points_.back().rate_B = samples.front().angular_velocity_B - bias_;
  for (size_t i = 1; i < samples.size(); ++i) {
    const double step_s = (samples[i].time - samples[i - 1].time).seconds();
    if (step_s > kGapSteps * usual_s) gaps_.push_back({samples[i - 1].time, samples[i].time});
    points_.push_back(advanced(points_.back(), samples[i].angular_velocity_B - bias_, step_s));
  }
}

bool GyroscopePath::covers(Time time) const {
  return samples_.front().time <= time && time <= samples_.back().time;
}

GyroscopePath::Point GyroscopePath::at(Time time) const {
  const auto after = std::upper_bound(samples_.begin(), samples_.end(), time,
                                      [](Time t, const ImuSample& sample) { return t < sample.time; });
  const size_t before = static_cast<size_t>(std::max<std::ptrdiff_t>(1, after - samples_.begin())) - 1;
  const size_t next = std::min(before + 1, samples_.size() - 1);
  const double whole_s = (samples_[next].time - samples_[before].time).seconds();
  const double part_s = (time - samples_[before].time).seconds();
  const double share = whole_s > 0.0 ? part_s / whole_s : 0.0;
  const Vec3 rate_B = (1.0 - share) * points_[before].rate_B + share * points_[next].rate_B;
  Point point = advanced(points_[before], rate_B, part_s);
  point.specific_force_B =
      (1.0 - share) * samples_[before].specific_force_B + share * samples_[next].specific_force_B;
  return point;
}

double GyroscopePath::gap_s(Time from, Time to) const {
  double total_s = 0.0;
  for (const Gap& gap : gaps_) {
    total_s += std::max(0.0, (std::min(gap.end, to) - std::max(gap.begin, from)).seconds());
  }
  return total_s;
}

}  // namespace lodeline
