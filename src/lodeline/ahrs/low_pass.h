#pragma once

#include <algorithm>
#include <cmath>

namespace lodeline {

/// Two first-order low-pass filters in series with a total delay of `time_constant_s`; time steps may vary.
/// Until that time has passed, each stage returns the mean of its inputs, which suppresses the initial
/// transient.
template <typename Value>
class LowPass {
 public:
  explicit LowPass(double time_constant_s) : stage_s_(0.5 * time_constant_s) {}

  const Value& update(const Value& input, double step_s) {
    if (elapsed_s_ == 0.0) {
      first_ = second_ = input;
      elapsed_s_ = step_s;
      return second_;
    }
    elapsed_s_ += step_s;
    const double gain = std::max(-std::expm1(-step_s / stage_s_), step_s / elapsed_s_);
    first_ += gain * (input - first_);
    second_ += gain * (first_ - second_);
    return second_;
  }

  const Value& value() const { return second_; }
  bool isEmpty() const { return elapsed_s_ == 0.0; }
  void reset() { elapsed_s_ = 0.0; }

 private:
  double stage_s_;
  double elapsed_s_ = 0.0;
  Value first_{}, second_{};
};

}  // namespace lodeline
