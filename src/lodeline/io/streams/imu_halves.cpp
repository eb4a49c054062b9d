#include "lodeline/io/streams/imu_halves.h"

#include <algorithm>

namespace lodeline {
namespace {

constexpr int kLongestGapInSteps = 4;

}  // namespace

bool ImuHalves::advance(const Next& accelerometer) {
  std::optional<ImuSample> reading = accelerometer();
  // Readings that go back in time cannot bracket another reading.
  while (reading && after_ && reading->time <= after_->time) reading = accelerometer();
  before_ = after_;
  after_ = reading;
  if (before_ && after_) {
    const Duration step = after_->time - before_->time;
    usual_step_ = usual_step_ ? std::min(*usual_step_, step) : step;
  }
  return after_.has_value();
}

std::optional<ImuSample> ImuHalves::next(const Next& gyroscope, const Next& accelerometer) {
  while (std::optional<ImuSample> sample = gyroscope()) {
    while (!after_ || after_->time < sample->time) {
      if (!advance(accelerometer)) return std::nullopt;
    }
    if (sample->time == after_->time) {
      sample->specific_force_B = after_->specific_force_B;
      return sample;
    }
    if (!before_ || sample->time < before_->time) continue;
    const double step_s = (after_->time - before_->time).seconds();
    if (step_s > kLongestGapInSteps * usual_step_->seconds()) continue;
    const double share = (sample->time - before_->time).seconds() / step_s;
    sample->specific_force_B = (1.0 - share) * before_->specific_force_B + share * after_->specific_force_B;
    return sample;
  }
  return std::nullopt;
}

}  // namespace lodeline
