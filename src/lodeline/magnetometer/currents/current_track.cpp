#include "lodeline/magnetometer/currents/current_track.h"

#include <algorithm>
#include <cmath>

namespace lodeline {
namespace {

constexpr double kGain = 0.05;  // of the faded means

}  // namespace

bool CurrentTrack::add(const CurrentSample& sample) {
  if (sample.currents_A.size() != channels_) return false;
  const Eigen::VectorXd currents_A =
      Eigen::Map<const Eigen::VectorXd>(sample.currents_A.data(), static_cast<Eigen::Index>(channels_));
  if (!currents_A.allFinite()) return false;
  if (!readings_.empty()) {
    const double since_s = (sample.time - readings_.back().time).seconds();
    if (!(since_s > 0.0)) return false;
    if (since_s <= longest_gap_s_) {
      const Eigen::VectorXd square = (currents_A - readings_.back().currents_A).cwiseAbs2();
      const bool is_first = usual_period_s_ == 0.0;
      usual_square_A2_ =
          is_first ? square : Eigen::VectorXd((1.0 - kGain) * usual_square_A2_ + kGain * square);
      usual_period_s_ = is_first ? since_s : (1.0 - kGain) * usual_period_s_ + kGain * since_s;
    }
  }
  readings_.push_back({sample.time, currents_A});
  return true;
}

void CurrentTrack::forgetBefore(Time time) {
  while (readings_.size() > 1 && readings_[1].time <= time) readings_.pop_front();
}

std::optional<CurrentsAt> CurrentTrack::at(Time time) const {
  const auto after = std::lower_bound(readings_.begin(), readings_.end(), time,
                                      [](const Reading& reading, Time at) { return reading.time < at; });
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(channels_));
  if (after != readings_.end() && after->time == time) return CurrentsAt{after->currents_A, none};
  if (after == readings_.begin()) return std::nullopt;
  const Reading& before = *std::prev(after);
  const double since_s = (time - before.time).seconds();
  if (after == readings_.end()) {
    if (since_s > longest_gap_s_ || usual_period_s_ == 0.0) return std::nullopt;
    const double share = std::max(since_s / usual_period_s_, 1e-3);
    return CurrentsAt{before.currents_A, share * usual_square_A2_.cwiseSqrt()};
  }
  const double step_s = (after->time - before.time).seconds();
  if (step_s > longest_gap_s_) return std::nullopt;
  return CurrentsAt{before.currents_A + since_s / step_s * (after->currents_A - before.currents_A), none};
}

}  // namespace lodeline
