#include "lodeline/io/streams/reading_history.h"

#include <algorithm>

namespace lodeline {
namespace {

double medianChange(std::span<const ImuSample> samples, Vec3 ImuSample::*reading) {
  std::vector<double> changes;
  changes.reserve(samples.size());
  for (size_t i = 1; i < samples.size(); ++i) {
    changes.push_back((samples[i].*reading - samples[i - 1].*reading).norm());
  }
  if (changes.empty()) return 0.0;
  const auto middle = changes.begin() + static_cast<std::ptrdiff_t>(changes.size() / 2);
  std::nth_element(changes.begin(), middle, changes.end());
  return *middle;
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
