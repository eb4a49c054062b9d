#include "lodeline/estimator/magnetometer/earth_field_search.h"

#include <algorithm>
#include <utility>

namespace lodeline {
namespace {

constexpr double kLongestInterval_s = 1.0;  // longest interval that counts when readings pause

}  // namespace

std::optional<Vec3> EarthFieldSearch::add(const Reading& reading) {
  const double since_s =
      last_time_ ? std::min((reading.time - *last_time_).seconds(), kLongestInterval_s) : 0.0;
  last_time_ = reading.time;
  if (reading.agrees) {
    agreed_s_ += since_s;
    candidate_W_.reset();
    return std::nullopt;
  }
  if (!reading.is_plausible || replacements_ == kMostReplacements) {
    candidate_W_.reset();
    return std::nullopt;
  }
  follow(reading, since_s);
  const bool has_held_longer = agreed_s_ < kConfirmed_s && held_s_ >= kLeast_s && held_s_ > agreed_s_;
  const bool is_only_choice = !reading.is_field_in_force_plausible && held_s_ >= kPlausible_s;
  if (!has_held_longer && !is_only_choice) return std::nullopt;
  agreed_s_ = held_s_;
  ++replacements_;
  return std::exchange(candidate_W_, std::nullopt);
}

void EarthFieldSearch::follow(const Reading& reading, double since_s) {
  const bool holds =
      candidate_W_ && (reading.field_W - *candidate_W_).norm() <= kSteadiness * candidate_W_->norm();
  if (!holds) {
    candidate_W_ = reading.field_W;
    readings_ = 1;
    held_s_ = 0.0;
    return;
  }
  ++readings_;
  *candidate_W_ += (reading.field_W - *candidate_W_) / readings_;
  held_s_ += since_s;
}

}  // namespace lodeline
