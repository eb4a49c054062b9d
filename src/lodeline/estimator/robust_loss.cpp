#include "lodeline/estimator/robust_loss.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

namespace lodeline {

namespace {

constexpr double kLn2 = std::numbers::ln2, kLn10 = std::numbers::ln10;
// 2 / nu. Lighter tails count as normal, heavier ones as this: a still narrower loss finds wrong minima where
// many points slide (robust_loss_test.cpp).
constexpr double kNormalTail = 2.0 / 9.3, kHeaviestTail = 2.0 / 4.0;

double quantile(double share, std::vector<double>* values) {
  const auto at = values->begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values->size()));
  std::nth_element(values->begin(), at, values->end());
  return *at;
}

/// 2 / nu of the t distribution whose 90 % quantile is `ratio` medians.
double tailOf(double ratio) {
  const auto ratioOf = [](double tail) {
    return std::sqrt(std::expm1(tail * kLn10) / std::expm1(tail * kLn2));
  };
  double least = kNormalTail, most = kHeaviestTail;
  if (ratio <= ratioOf(least)) return least;
  for (int i = 0; i < 20; ++i) {
    const double middle = 0.5 * (least + most);
    (ratioOf(middle) < ratio ? least : most) = middle;
  }
  return most;
}

/// `sigmas` of those frames where they are known.
void weighTracks(Window& window, const std::vector<SightingError>& errors,
                 const std::map<FrameId, double>& sigmas) {
  struct OfTrack {
    double sum_of_squares = 0.0;
    int count = 0;
  };
  std::map<TrackId, OfTrack> by_track;
  for (const SightingError& error : errors) {
    const auto sigma = sigmas.find(error.frame);
    if (sigma == sigmas.end()) continue;
    OfTrack& of_track = by_track[error.track];
    of_track.sum_of_squares += (error.sigmas / sigma->second) * (error.sigmas / sigma->second);
    ++of_track.count;
  }
  for (auto& [id, track] : window.tracks()) {
    const OfTrack& of_track = by_track[id];
    track.weight = trackWeight(of_track.sum_of_squares, of_track.count);
  }
}

}  // namespace

std::optional<FrameErrors> frameErrors(std::vector<double> errors_sigmas, const SolverOptions& options) {
  constexpr size_t kEnough = 20;
  // Images without noise must not end in a loss that rejects everything.
  constexpr double kLeast_sigmas = 0.02;
  if (errors_sigmas.size() < kEnough) return std::nullopt;
  const double median = std::max(quantile(0.5, &errors_sigmas), kLeast_sigmas);
  const double ratio = quantile(0.9, &errors_sigmas) / median;
  const double narrowing = std::sqrt(std::expm1(kNormalTail * kLn2) / std::expm1(tailOf(ratio) * kLn2));
  const double sigma = median / std::sqrt(2.0 * kLn2);  // as of a Rayleigh distribution
  return FrameErrors{
      sigma, std::min(narrowing * options.robust_scale_medians * median, options.robust_scale_sigmas)};
}

double trackWeight(double sum_of_squares, int count) {
  constexpr double kBeforehand = 1.0, kMost = 2.0;
  const double inverse_variance = (kBeforehand + 2.0 * count) / (kBeforehand + sum_of_squares);
  return std::min(inverse_variance * inverse_variance, kMost);
}

void adaptRobustLosses(Window& window, const std::vector<SightingError>& errors,
                       const SolverOptions& options) {
  std::map<FrameId, std::vector<double>> by_frame;
  for (const SightingError& error : errors) by_frame[error.frame].push_back(error.sigmas);
  std::map<FrameId, double> sigmas;
  for (auto& [id, of_frame] : by_frame) {
    const auto found = frameErrors(std::move(of_frame), options);
    if (!found) continue;
    window.find(id)->robust_scale_sigmas = found->width;
    sigmas[id] = found->sigma;
  }
  if (options.track_weights) weighTracks(window, errors, sigmas);
}

void resetRobustLosses(Window& window) {
  for (const auto& frame : window.frames()) frame->robust_scale_sigmas.reset();
  for (auto& [id, track] : window.tracks()) track.weight = 1.0;
}

}  // namespace lodeline
