#pragma once

#include <optional>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/estimate.h"

namespace lodeline {

/// A time span without usable images, in which inertial readings alone propagated the pose.
struct BlindStretch {
  Time start, end;  ///< of its first frame; of the first frame with images after it, or of its last frame
  double sigma_start_m = 0.0;  ///< of the position (root of the trace of its covariance), at the start
  double sigma_end_m = 0.0;    ///< largest value in the span

  double seconds() const { return (end - start).seconds(); }
};

/// Finds the blind spans among the frames of a run, given in order.
class BlindStretches {
 public:
  void add(const FrameEstimate& estimate);

  const std::vector<BlindStretch>& stretches() const { return stretches_; }
  double total_s() const;

  /// Reports the spans of at least `least_s` as one finding, `blind_stretch`, with the time span and the
  /// growth of uncertainty of the longest. Times count from `origin`.
  void report(Time origin, double least_s, Diagnostics* diagnostics) const;

 private:
  std::vector<BlindStretch> stretches_;
  bool is_blind_ = false;
  double last_sigma_m_ = 0.0;
};

}  // namespace lodeline
