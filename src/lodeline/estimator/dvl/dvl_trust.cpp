#include "lodeline/estimator/dvl/dvl_trust.h"

#include <algorithm>

namespace lodeline {

void DvlTrust::add(Time time, bool agrees, bool is_test) {
  if (!agrees) {
    count_ = std::min(count_ + 1, 2 * kDoubt);
  } else if (is_test) {
    count_ = std::max(count_ - 1, 0);
  }
  if (is_trusted_ && count_ >= kDoubt) {
    is_trusted_ = false;
    waits_since_ = time;
  }
  waits_since_ = waits_since_.value_or(time);
  waited_s_ = (time - *waits_since_).seconds();
  // A sensor that has never disagreed is trusted after the wait, although nothing could test it.
  const bool has_no_fault = count_ <= kFirst && waited_s_ > longest_wait_s_;
  if (count_ == 0 || (!is_trusted_ && has_no_fault)) is_trusted_ = true;
  if (is_trusted_) waited_s_ = 0.0;
}

}  // namespace lodeline
