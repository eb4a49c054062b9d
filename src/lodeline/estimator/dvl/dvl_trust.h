#pragma once

#include <optional>

#include "lodeline/types.h"

namespace lodeline {

/// Trust in a velocity sensor, by the record of its pings against the prediction. A ping that disagrees
/// counts one up, a ping that agrees one down, between 0 and 2 kDoubt. An agreement counts only where a wrong
/// ping would have been noticed, because a prediction that knows nothing agrees with everything. The sensor
/// is trusted from count 0 until count kDoubt. It begins at kFirst, so that it passes some tests before it is
/// used. A sensor that is not trusted gives no measurement. A single ping of it may agree with the prediction
/// although the sensor is wrong.
class DvlTrust {
 public:
  /// `longest_wait_s`: after this time without trust, the prediction may be what is wrong.
  explicit DvlTrust(double longest_wait_s) : longest_wait_s_(longest_wait_s) {}

  /// `is_test`: a wrong ping would have disagreed.
  void add(Time time, bool agrees, bool is_test);

  bool isTrusted() const { return is_trusted_; }
  /// Whether it has waited for trust for longer than `longest_wait_s`.
  bool isOverdue() const { return !is_trusted_ && waited_s_ > longest_wait_s_; }
  /// Time without trust up to the last ping, s.
  double waited_s() const { return waited_s_; }

 private:
  static constexpr int kFirst = 2, kDoubt = 4;

  double longest_wait_s_;
  bool is_trusted_ = false;
  int count_ = kFirst;
  double waited_s_ = 0.0;
  std::optional<Time> waits_since_;
};

}  // namespace lodeline
