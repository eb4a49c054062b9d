#include "lodeline/output/survey/depth/depth_alignment.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "lodeline/diagnostics.h"
#include "lodeline/magnetometer/iron/iron_fit.h"
#include "lodeline/trajectory.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

/// The run's depth relative to its origin, on a regular grid.
std::vector<DepthReading> runDepths(const Trajectory& trajectory, size_t count) {
  const std::vector<StampedPose>& poses = trajectory.poses;
  const double begin_s = poses.front().time.seconds(), end_s = poses.back().time.seconds();
  std::vector<DepthReading> depths;
  size_t next = 0;
  for (size_t k = 0; k < count; ++k) {
    const double time_s =
        begin_s + (end_s - begin_s) * static_cast<double>(k) / static_cast<double>(count - 1);
    while (next + 1 < poses.size() && poses[next].time.seconds() < time_s) ++next;
    depths.push_back({time_s, -poses[next].world_from_body.translation.z()});
  }
  return depths;
}

/// Interpolates the profile between its readings, for times that increase from call to call; empty outside,
/// and in gaps longer than its own limit.
class ProfileReader {
 public:
  explicit ProfileReader(const DepthProfile& profile) : profile_(profile), after_(profile.readings.begin()) {}

  std::optional<double> at(double time_s) {
    const auto end = profile_.readings.end();
    const auto isBefore = [](const DepthReading& r, double t) { return r.time_s < t; };
    // Search with doubling steps, which finds a nearby reading quickly.
    std::ptrdiff_t step = 1;
    auto from = after_;
    while (end - from > step && from[step].time_s < time_s) {
      from += step;
      step *= 2;
    }
    after_ = std::lower_bound(from, end - from > step ? from + step + 1 : end, time_s, isBefore);
    if (after_ == end) return std::nullopt;
    if (after_->time_s == time_s) return after_->depth_m;
    if (after_ == profile_.readings.begin()) return std::nullopt;
    const DepthReading& before = *(after_ - 1);
    const double gap_s = after_->time_s - before.time_s;
    if (gap_s > profile_.max_gap_s) return std::nullopt;
    return before.depth_m + (after_->depth_m - before.depth_m) * (time_s - before.time_s) / gap_s;
  }

 private:
  const DepthProfile& profile_;
  std::vector<DepthReading>::const_iterator after_;  ///< the first reading that is not before the last time
};

/// Compares the run with the profile at one lag.
class LagCost {
 public:
  LagCost(const DepthProfile& profile, std::vector<DepthReading> run)
      : profile_(profile), run_(std::move(run)) {
    const double run_s = run_.back().time_s - run_.front().time_s;
    const double profile_s = profile.readings.back().time_s - profile.readings.front().time_s;
    fewest_ = static_cast<size_t>(0.8 * std::min(1.0, profile_s / run_s) * static_cast<double>(run_.size()));
  }

  /// Profile minus run in their common time.
  std::vector<double> differences(double lag_s) const {
    std::vector<double> result;
    ProfileReader profile(profile_);
    for (const DepthReading& reading : run_) {
      if (const std::optional<double> depth_m = profile.at(reading.time_s - lag_s)) {
        result.push_back(*depth_m - reading.depth_m);
      }
    }
    return result;
  }

  /// Mean absolute deviation from the median, without the worst tenth; infinite with too little overlap.
  double operator()(double lag_s) const {
    std::vector<double> values = differences(lag_s);
    if (values.size() < std::max<size_t>(fewest_, 3)) return std::numeric_limits<double>::infinity();
    const double usual = median(values);
    for (double& value : values) value = std::abs(value - usual);
    const size_t kept = values.size() - values.size() / 10;
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(kept - 1), values.end());
    double sum = 0.0;
    for (size_t i = 0; i < kept; ++i) sum += values[i];
    return sum / static_cast<double>(kept);
  }

  double firstLag() const { return run_.front().time_s - profile_.readings.back().time_s; }
  double lastLag() const { return run_.back().time_s - profile_.readings.front().time_s; }
  double runSeconds() const { return run_.back().time_s - run_.front().time_s; }

 private:
  const DepthProfile& profile_;
  std::vector<DepthReading> run_;
  size_t fewest_ = 0;
};

struct LagSearch {
  double lag_s = 0.0;
  double cost = std::numeric_limits<double>::infinity();
  /// Smallest cost of another minimum: at a lag beyond the maximum next to the best.
  double rival_cost = std::numeric_limits<double>::infinity();
};

/// The best of equally spaced lags, and the best outside its minimum (which extends to the next maximum on
/// both sides).
LagSearch searchLags(const LagCost& cost, double first_s, double last_s, double step_s) {
  std::vector<double> costs;
  const auto count = static_cast<size_t>(std::max(1.0, std::floor((last_s - first_s) / step_s) + 1.0));
  for (size_t i = 0; i < count; ++i) costs.push_back(cost(first_s + static_cast<double>(i) * step_s));
  const auto best = static_cast<size_t>(std::min_element(costs.begin(), costs.end()) - costs.begin());
  LagSearch result{first_s + static_cast<double>(best) * step_s, costs[best]};
  size_t left = best, right = best;
  while (left > 0 && (costs[left - 1] >= costs[left] || costs[left - 1] < 1.5 * costs[best])) --left;
  while (right + 1 < count && (costs[right + 1] >= costs[right] || costs[right + 1] < 1.5 * costs[best]))
    ++right;
  for (size_t i = 0; i < left; ++i) result.rival_cost = std::min(result.rival_cost, costs[i]);
  for (size_t i = right + 1; i < count; ++i) result.rival_cost = std::min(result.rival_cost, costs[i]);
  return result;
}

/// Root of the mean square of the run's vertical speed, m/s.
double verticalSpeed(const std::vector<DepthReading>& run) {
  double sum = 0.0;
  for (size_t i = 1; i < run.size(); ++i) {
    const double speed = (run[i].depth_m - run[i - 1].depth_m) / (run[i].time_s - run[i - 1].time_s);
    sum += speed * speed;
  }
  return std::sqrt(sum / static_cast<double>(run.size() - 1));
}

/// Slope of the profile's depth over the run's, by least squares.
double slopeOf(const std::vector<DepthComparison>& pairs) {
  double mean_run = 0.0, mean_profile = 0.0, covariance = 0.0, variance = 0.0;
  for (const DepthComparison& pair : pairs) {
    mean_run += pair.run_depth_m / static_cast<double>(pairs.size());
    mean_profile += pair.profile_depth_m / static_cast<double>(pairs.size());
  }
  for (const DepthComparison& pair : pairs) {
    covariance += (pair.run_depth_m - mean_run) * (pair.profile_depth_m - mean_profile);
    variance += (pair.run_depth_m - mean_run) * (pair.run_depth_m - mean_run);
  }
  constexpr double kLeastStandardDeviation_m = 1.0;
  const double enough =
      kLeastStandardDeviation_m * kLeastStandardDeviation_m * static_cast<double>(pairs.size());
  return variance > enough ? covariance / variance : 1.0;
}

std::string doubtOf(const LagSearch& search, const std::vector<DepthReading>& run, double resolution_m) {
  std::vector<double> depths;
  for (const DepthReading& reading : run) depths.push_back(reading.depth_m);
  const Statistics spread = computeStatistics(depths);
  if (spread.std < 2.0 * std::max(resolution_m, 0.02)) {
    return fmt::format("the run's depth varies by only {:.2f} m (standard deviation)", spread.std);
  }
  if (search.rival_cost < 1.5 * std::max(search.cost, 0.25 * resolution_m)) {
    return "another lag fits nearly as well";
  }
  if (search.cost > 0.5 * spread.std) {
    return fmt::format("the courses differ by {:.2f} m at best (do both belong to the same dive?)",
                       search.cost);
  }
  return "";
}

/// Reason for doubt. A lag from the search must be accurate, and depths must change like the run's. A stated
/// lag is accepted, and only a ratio that cannot be a scale error of a run is doubtful.
std::string doubtOfFit(const DepthAlignment& fit, double run_s, bool lag_is_known) {
  constexpr double kLeastLagSigma_s = 5.0, kLagSigmaShare = 0.02, kMostRatio = 1.33,
                   kMostRatioAtKnownLag = 2.0;
  constexpr double kLeastCommonShare = 0.3, kMostAboveWater_m = 0.5;
  if (fit.start_depth_m < -kMostAboveWater_m) {
    return fmt::format("the first pose would be {:.2f} m above the water", -fit.start_depth_m);
  }
  if (!lag_is_known && fit.common_s < kLeastCommonShare * run_s) {
    return fmt::format("the profile covers {:.0f} s of the run's {:.0f} s only", fit.common_s, run_s);
  }
  if (!lag_is_known && fit.lag_sigma_s > std::max(kLeastLagSigma_s, kLagSigmaShare * fit.common_s)) {
    return fmt::format("the lag is known to {:.0f} s only", fit.lag_sigma_s);
  }
  const double most = lag_is_known ? kMostRatioAtKnownLag : kMostRatio;
  if (fit.slope > most || fit.slope < 1.0 / most) {
    return fmt::format("the profile's depths change by {:.3g} m where the run's change by one", fit.slope);
  }
  return "";
}

}  // namespace

DepthAlignment alignDepths(const DepthProfile& profile, const Trajectory& trajectory,
                           std::optional<double> known_lag_s) {
  const std::vector<DepthReading> coarse = runDepths(trajectory, 300), fine = runDepths(trajectory, 3000);
  const LagCost coarse_cost(profile, coarse), fine_cost(profile, fine);
  DepthAlignment result;
  if (known_lag_s) {
    result.lag_s = *known_lag_s;
  } else {
    // Limits the computing time for profiles of any length.
    constexpr double kMostLags = 1e5;
    const double range_s = coarse_cost.lastLag() - coarse_cost.firstLag();
    const double step_s =
        std::max(std::clamp(coarse_cost.runSeconds() / 300.0, 0.1, 1.0), range_s / kMostLags);
    const LagSearch search = searchLags(coarse_cost, coarse_cost.firstLag(), coarse_cost.lastLag(), step_s);
    result.doubt = doubtOf(search, coarse, profile.resolution_m);
    result.lag_s =
        searchLags(fine_cost, search.lag_s - 1.5 * step_s, search.lag_s + 1.5 * step_s, 0.05 * step_s).lag_s;
  }
  const std::vector<double> differences = fine_cost.differences(result.lag_s);
  if (differences.size() < 3) {
    throw InputError(
        fmt::format("{}: the profile and the run have no time in common{}; leave --profile-lag out to "
                    "have it found",
                    profile.name, known_lag_s ? " at this lag" : ""));
  }
  result.start_depth_m = computeStatistics(differences).median;
  std::vector<double> deviations = differences;
  for (double& d : deviations) d -= result.start_depth_m;
  result.rms_m = computeStatistics(deviations).rmse;
  result.common_s =
      fine_cost.runSeconds() * static_cast<double>(differences.size()) / static_cast<double>(fine.size());
  result.slope = slopeOf(compareDepths(profile, trajectory, result));
  // Neighbouring differences are correlated; this is the number of independent ones.
  const double independent = static_cast<double>(deviations.size()) / correlationFactor(deviations);
  result.lag_sigma_s =
      result.rms_m / std::max(verticalSpeed(coarse), 1e-3) / std::sqrt(std::max(independent, 1.0));
  if (result.doubt.empty())
    result.doubt = doubtOfFit(result, fine_cost.runSeconds(), known_lag_s.has_value());
  return result;
}

std::vector<DepthComparison> compareDepths(const DepthProfile& profile, const Trajectory& trajectory,
                                           const DepthAlignment& alignment) {
  std::vector<DepthComparison> pairs;
  ProfileReader reader(profile);
  for (const StampedPose& pose : trajectory.poses) {
    const std::optional<double> depth_m = reader.at(pose.time.seconds() - alignment.lag_s);
    if (!depth_m) continue;
    pairs.push_back({pose.time, alignment.start_depth_m - pose.world_from_body.translation.z(), *depth_m});
  }
  return pairs;
}

}  // namespace lodeline
