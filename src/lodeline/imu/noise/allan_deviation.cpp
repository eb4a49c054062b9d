#include "lodeline/imu/noise/allan_deviation.h"

namespace lodeline {

AllanAccumulator::Level AllanAccumulator::makeLevel(bool is_first) {
  Level level;
  if (is_first) {
    for (const int factor : {1, 2, 3, 4, 5, 6, 7, 8, 10, 12, 14}) level.sums.push_back({factor});
  }
  for (const int factor : {kFirstFactor, 20, 24, 28}) level.sums.push_back({factor});
  return level;
}

void AllanAccumulator::add(const Eigen::Array3d& integral, Level* level) {
  const auto at = [level](int64_t index) -> Eigen::Array3d& {
    return level->integral[static_cast<size_t>(index % kHistory)];
  };
  const int64_t last = level->count++;
  at(last) = integral;
  for (Sum& sum : level->sums) {
    if (last < 2 * sum.factor) break;  // factors are ascending
    sum.squares += (integral - 2.0 * at(last - sum.factor) + at(last - 2 * sum.factor)).square();
    ++sum.terms;
  }
}

void AllanAccumulator::add(const Vec3& reading) {
  if (count_ == 0) origin_ = reading.array();
  if (levels_.empty()) levels_.push_back(makeLevel(true));
  // The integral before the first reading of a stretch is a point too.
  if (since_break_ == 0) {
    for (Level& level : levels_) add(integral_, &level);
  }
  integral_ += reading.array() - origin_;
  ++since_break_;
  ++count_;
  for (size_t i = 0; since_break_ % (int64_t{1} << i) == 0; ++i) {
    if (i == levels_.size()) {
      // A level is created when the first stretch is long enough for it; only the start of the integral is
      // then missing.
      levels_.push_back(makeLevel(false));
      add(Eigen::Array3d::Zero(), &levels_.back());
    }
    add(integral_, &levels_[i]);
  }
}

void AllanAccumulator::breakOff() {
  for (Level& level : levels_) level.count = 0;
  integral_.setZero();
  since_break_ = 0;
}

AllanCurve AllanAccumulator::curve(double interval_s) const {
  AllanCurve curve;
  curve.interval_s = interval_s;
  curve.duration_s = static_cast<double>(count_) * interval_s;
  for (size_t i = 0; i < levels_.size(); ++i) {
    for (const Sum& sum : levels_[i].sums) {
      if (sum.terms == 0) continue;
      AllanPoint point;
      point.stride = int64_t{1} << i;
      point.factor = sum.factor * point.stride;
      point.terms = sum.terms;
      point.tau_s = static_cast<double>(point.factor) * interval_s;
      const double squared_factor = static_cast<double>(point.factor) * static_cast<double>(point.factor);
      // The integral has units of reading * interval, so that the interval cancels.
      point.variance = sum.squares.matrix() / (2.0 * squared_factor * static_cast<double>(sum.terms));
      curve.points.push_back(point);
    }
  }
  return curve;
}

}  // namespace lodeline
