#include "lodeline/estimator/pressure/depth_gate.h"

#include <algorithm>
#include <cmath>

namespace lodeline {

const char* toString(DepthStatus status) {
  switch (status) {
    case DepthStatus::Off:
      return "off";
    case DepthStatus::NoData:
      return "no data";
    case DepthStatus::Used:
      return "used";
    case DepthStatus::Jump:
      return "jump";
    case DepthStatus::Restarted:
      return "restarted";
    case DepthStatus::Frozen:
      return "frozen";
    case DepthStatus::Slope:
      return "slope";
  }
  return "unknown";
}

DepthDecision DepthGate::decide(Time time, double innovation_m, double sigma_m) {
  const double limit_m = std::max(options_.max_jump_m, options_.max_sigmas * sigma_m);
  if (std::min(std::abs(innovation_m), std::abs(innovation_m - last_used_m_)) <= limit_m) {
    rejection_.reset();
    last_used_m_ = innovation_m;
    return {DepthStatus::Used, true, std::max(1.0, std::abs(innovation_m) / limit_m)};
  }
  if (!rejection_) rejection_ = Rejection{time, time, innovation_m, innovation_m};
  rejection_->least_m = std::min(rejection_->least_m, innovation_m);
  rejection_->greatest_m = std::max(rejection_->greatest_m, innovation_m);
  if (rejection_->greatest_m - rejection_->least_m > limit_m) {
    rejection_->steady_since = time;
    rejection_->least_m = rejection_->greatest_m = innovation_m;
  }
  if ((time - rejection_->steady_since).seconds() < options_.readmission_s) return {DepthStatus::Jump};
  rejection_.reset();
  last_used_m_ = 0.0;
  return {DepthStatus::Restarted, true};
}

}  // namespace lodeline
