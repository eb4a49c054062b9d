#include "lodeline/io/streams/repeat_detector.h"

#include <cmath>

namespace lodeline {

void RepeatDetector::Triad::add(const Vec3& before, const Vec3& reading, const Vec3& other, Time time) {
  constexpr double kOf = 0.25;  // weight of the newest fraction in the running mean
  const auto same = (before.array() == reading.array()).count();
  repeats_ = same == 3;
  if (repeats_) {
    other_least_ = other_least_.cwiseMin(other);
    other_greatest_ = other_greatest_.cwiseMax(other);
    return;
  }
  has_changed_ |= before.allFinite();
  share_ += kOf * (static_cast<double>(same) / 3.0 - share_);
  since_ = time;
  other_least_ = other_greatest_ = other;
}

bool RepeatDetector::Triad::isStuck(Time now, double moving) const {
  constexpr double kLong_s = 0.1;
  return repeats_ && (resolvesFinely() || !has_changed_) && (now - since_).seconds() > kLong_s &&
         (other_greatest_ - other_least_).maxCoeff() > moving;
}

RepeatDetector::Verdict RepeatDetector::judge(const ImuSample& sample) {
  constexpr double kTurning_rad_per_s = 0.3, kMoving_m_per_s2 = 1.5;
  const ImuSample before = before_.value_or(ImuSample{sample.time, Vec3::Constant(NAN), Vec3::Constant(NAN)});
  before_ = sample;
  gyroscope_.add(before.angular_velocity_B, sample.angular_velocity_B, sample.specific_force_B, sample.time);
  accelerometer_.add(before.specific_force_B, sample.specific_force_B, sample.angular_velocity_B,
                     sample.time);
  if (gyroscope_.repeats() && accelerometer_.repeats()) {
    return gyroscope_.resolvesFinely() && accelerometer_.resolvesFinely() ? Verdict::Held : Verdict::Fresh;
  }
  return gyroscope_.isStuck(sample.time, kMoving_m_per_s2) ||
                 accelerometer_.isStuck(sample.time, kTurning_rad_per_s)
             ? Verdict::Stuck
             : Verdict::Fresh;
}

}  // namespace lodeline
