#include "lodeline/problem/robust_loss.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "lodeline/util/median.h"

namespace lodeline {

namespace {

constexpr double kLn2 = std::numbers::ln2, kLn10 = std::numbers::ln10;
// Range of 2 / nu. Lighter tails count as normal, heavier ones as the limit: a narrower loss finds wrong
// minima where many points slide (robust_loss_test.cpp).
constexpr double kNormalTail = 2.0 / 9.3, kHeaviestTail = 2.0 / 4.0;

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

/// Sums the squared residuals of each track, relative to `sigmas`, over the frames in `sigmas`.
ErrorsByTrack errorsByTrack(const std::vector<ObservationError>& errors,
                            const boost::container::flat_map<FrameId, double>& sigmas) {
  ErrorsByTrack by_track;
  for (const ObservationError& error : errors) {
    const auto sigma = sigmas.find(error.frame);
    if (sigma == sigmas.end()) continue;
    TrackErrors& of_track = by_track[error.track];
    of_track.sum_of_squares += (error.sigmas / sigma->second) * (error.sigmas / sigma->second);
    ++of_track.count;
  }
  return by_track;
}

/// Deviation of a track's mean square from 1, in sigmas of a chi-squared variable (E. B. Wilson, M. M.
/// Hilferty, "The distribution of chi-square", PNAS 17, 1931).
double deviation(const TrackErrors& of_track) {
  const double degrees = of_track.degreesOfFreedom();
  const double variance = 2.0 / (9.0 * degrees);
  return (std::cbrt(of_track.sum_of_squares / degrees) - (1.0 - variance)) / std::sqrt(variance);
}

}  // namespace

std::optional<FrameErrors> frameErrors(std::vector<double> errors_sigmas, const SolverOptions& options) {
  constexpr size_t kEnough = 20;
  // Lower limit for images without noise, for which the loss would reject everything.
  constexpr double kLeast_sigmas = 0.02;
  if (errors_sigmas.size() < kEnough) return std::nullopt;
  const double median = std::max(lodeline::median(errors_sigmas), kLeast_sigmas);
  const double ratio = orderStatistic(std::move(errors_sigmas), 0.9) / median;
  const double narrowing = std::sqrt(std::expm1(kNormalTail * kLn2) / std::expm1(tailOf(ratio) * kLn2));
  const double sigma = median / std::sqrt(2.0 * kLn2);  // by the median of a Rayleigh distribution
  return FrameErrors{
      sigma, std::min(narrowing * options.robust_scale_medians * median, options.robust_scale_sigmas)};
}

double differenceOfTracks(const ErrorsByTrack& by_track) {
  constexpr size_t kEnough = 20;
  constexpr double kNormalQuantile = 1.2816;  // 90 %
  if (by_track.size() < kEnough) return 0.0;
  std::vector<double> deviations;
  for (const auto& [id, of_track] : by_track) deviations.push_back(deviation(of_track));
  const double median = lodeline::median(deviations);
  const double spread = (orderStatistic(deviations, 0.9) - median) / kNormalQuantile;
  return spread > 1.0 ? 1.0 - 1.0 / (spread * spread) : 0.0;
}

double trackWeight(const TrackErrors& errors, double difference) {
  constexpr double kBeforehand = 1.0, kMost = 2.0;
  const double inverse_variance =
      (kBeforehand + errors.degreesOfFreedom()) / (kBeforehand + errors.sum_of_squares);
  return std::min(std::pow(inverse_variance, 2.0 * difference), kMost);
}

void adaptRobustLosses(Window& window, const std::vector<ObservationError>& errors,
                       const SolverOptions& options) {
  boost::container::flat_map<FrameId, std::vector<double>> by_frame;
  for (const ObservationError& error : errors) by_frame[error.frame].push_back(error.sigmas);
  boost::container::flat_map<FrameId, double> sigmas;
  for (auto& [id, of_frame] : by_frame) {
    const auto found = frameErrors(std::move(of_frame), options);
    if (!found) continue;
    window.find(id)->robust_scale_sigmas = found->width;
    sigmas[id] = found->sigma;
  }
  if (!options.track_weights) return;
  const ErrorsByTrack by_track = errorsByTrack(errors, sigmas);
  const double difference = differenceOfTracks(by_track);
  for (auto& [id, track] : window.tracks()) {
    const auto found = by_track.find(id);
    track.weight = found == by_track.end() ? 1.0 : trackWeight(found->second, difference);
  }
}

void resetRobustLosses(Window& window) {
  for (const auto& frame : window.frames()) frame->robust_scale_sigmas.reset();
  for (auto& [id, track] : window.tracks()) track.weight = 1.0;
}

}  // namespace lodeline
