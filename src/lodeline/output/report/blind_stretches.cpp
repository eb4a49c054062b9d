#include "lodeline/output/report/blind_stretches.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lodeline/output/report/readable_times.h"

namespace lodeline {
namespace {

double positionSigma_m(const FrameEstimate& estimate) {
  return std::sqrt(std::max(0.0, estimate.covariance.diagonal().head<3>().sum()));
}

}  // namespace

void BlindStretches::add(const FrameEstimate& estimate) {
  if (estimate.status == Status::Waiting) return;
  const bool is_blind = estimate.status == Status::Inertial;
  const double sigma_m = positionSigma_m(estimate);
  if (is_blind && !is_blind_) stretches_.push_back({estimate.time, estimate.time, last_sigma_m_, sigma_m});
  if (is_blind || is_blind_) stretches_.back().end = estimate.time;
  if (is_blind) stretches_.back().sigma_end_m = std::max(stretches_.back().sigma_end_m, sigma_m);
  is_blind_ = is_blind;
  last_sigma_m_ = sigma_m;
}

double BlindStretches::total_s() const {
  double total_s = 0.0;
  for (const BlindStretch& stretch : stretches_) total_s += stretch.seconds();
  return total_s;
}

void BlindStretches::report(Time origin, double least_s, Diagnostics* diagnostics) const {
  const BlindStretch* longest = nullptr;
  int count = 0;
  double total_s = 0.0;
  for (const BlindStretch& stretch : stretches_) {
    if (stretch.seconds() < least_s) continue;
    ++count;
    total_s += stretch.seconds();
    if (longest == nullptr || stretch.seconds() > longest->seconds()) longest = &stretch;
  }
  if (longest == nullptr) return;
  std::string message = fmt::format(
      "{} to {}: no usable images; other sensors carried the pose for {:.1f} s, and the position's "
      "uncertainty grew from {:.2g} m to {:.2g} m",
      clockText((longest->start - origin).seconds()), clockText((longest->end - origin).seconds()),
      longest->seconds(), longest->sigma_start_m, longest->sigma_end_m);
  if (count > 1)
    message += fmt::format(" (the longest of {} such stretches, {:.1f} s together)", count, total_s);
  diagnostics->report(Severity::Warning, "blind_stretch", message);
}

}  // namespace lodeline
