#pragma once

#include <span>
#include <vector>

#include "lodeline/rig.h"

namespace lodeline {

/// Median change between consecutive readings, which a few outliers do not affect.
struct ReadingScale {
  double rate_rad_per_s = 0.0;
  double force_m_per_s2 = 0.0;
};

/// Median change of readings in order of time; zero for fewer than two.
ReadingScale scaleOf(std::span<const ImuSample> samples);

/// The last accepted readings, in constant memory.
class ReadingHistory {
 public:
  void add(const ImuSample& sample);
  bool empty() const { return samples_.empty(); }
  /// Whether there are enough readings to compute a scale.
  bool isFull() const { return samples_.size() == kReadings; }
  const ImuSample& last() const { return samples_.back(); }
  ReadingScale scale() const { return scaleOf(samples_); }
  std::span<const ImuSample> samples() const { return samples_; }

 private:
  static constexpr size_t kReadings = 17;

  std::vector<ImuSample> samples_;  ///< oldest first
};

}  // namespace lodeline
