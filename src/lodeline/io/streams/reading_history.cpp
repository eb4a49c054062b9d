#include "lodeline/io/streams/reading_history.h"

#include "lodeline/util/median.h"

namespace lodeline {
namespace {

double medianChange(std::span<const ImuSample> samples, Vec3 ImuSample::*reading) {
  std::vector<double> changes;
  changes.reserve(samples.size());
  for (size_t i = 1; i < samples.size(); ++i) {
    changes.push_back((samples[i].*reading - samples[i - 1].*reading).norm());
  }
  return median(std::move(changes));
}

}  // namespace

ReadingScale scaleOf(std::span<const ImuSample> samples) {
  return {medianChange(samples, &ImuSample::angular_velocity_B),
          medianChange(samples, &ImuSample::specific_force_B)};
}

void ReadingHistory::add(const ImuSample& sample) {
  if (isFull()) samples_.erase(samples_.begin());
  samples_.push_back(sample);
}

}  // namespace lodeline
