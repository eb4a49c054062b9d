#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "lodeline/output/survey/depth/depth_alignment.h"
#include "lodeline/output/survey/depth/nearest_points.h"
#include "lodeline/trajectory.h"

namespace lodeline {
namespace {

constexpr double kWindow_s = 20.0;

/// Values over time, in the order of time.
struct Series {
  std::vector<double> times_s, values;

  /// Range of the indices whose times are within half a window of a time.
  std::pair<size_t, size_t> around(double time_s) const {
    const auto begin = std::lower_bound(times_s.begin(), times_s.end(), time_s - 0.5 * kWindow_s);
    const auto end = std::upper_bound(times_s.begin(), times_s.end(), time_s + 0.5 * kWindow_s);
    return {static_cast<size_t>(begin - times_s.begin()), static_cast<size_t>(end - times_s.begin())};
  }

  double at(double time_s) const {
    const auto after = std::lower_bound(times_s.begin(), times_s.end(), time_s);
    if (after == times_s.begin()) return values.front();
    if (after == times_s.end()) return values.back();
    const auto i = static_cast<size_t>(after - times_s.begin());
    const double share = (time_s - times_s[i - 1]) / (times_s[i] - times_s[i - 1]);
    return values[i - 1] + share * (values[i] - values[i - 1]);
  }
};

/// The series with every value replaced by `reduce` of the values around it.
template <typename Reduce>
Series filtered(const Series& series, const Reduce& reduce) {
  Series result{series.times_s, {}};
  for (double time_s : series.times_s) {
    const auto [begin, end] = series.around(time_s);
    result.values.push_back(
        reduce(std::vector<double>(series.values.begin() + static_cast<std::ptrdiff_t>(begin),
                                   series.values.begin() + static_cast<std::ptrdiff_t>(end))));
  }
  return result;
}

/// Smoothed difference of profile and run, about once a second: the correction of the run's depth.
Series smoothDifferences(const std::vector<DepthComparison>& pairs) {
  Series series;
  for (const DepthComparison& pair : pairs) {
    const double time_s = pair.time.seconds();
    if (!series.times_s.empty() && time_s - series.times_s.back() < 0.9) continue;
    series.times_s.push_back(time_s);
    series.values.push_back(pair.profile_depth_m - pair.run_depth_m);
  }
  series =
      filtered(series, [](const std::vector<double>& values) { return computeStatistics(values).median; });
  return filtered(series, [](const std::vector<double>& values) { return computeStatistics(values).mean; });
}

/// Root mean square of the part that the smoothing removed.
double scatterAbout(const Series& smooth, const std::vector<DepthComparison>& pairs) {
  std::vector<double> rests;
  for (const DepthComparison& pair : pairs) {
    rests.push_back(pair.profile_depth_m - pair.run_depth_m - smooth.at(pair.time.seconds()));
  }
  return computeStatistics(rests).rmse;
}

}  // namespace

double correctDepths(const DepthProfile& profile, const DepthAlignment& alignment, RunFolder* run) {
  std::vector<StampedPose>& poses = run->trajectory.poses;
  const std::vector<DepthComparison> pairs = compareDepths(profile, run->trajectory, alignment);
  const Series smooth = smoothDifferences(pairs);
  const double first_m = smooth.at(poses.front().time.seconds());

  std::vector<Vec3> way;
  std::vector<double> shifts;
  for (StampedPose& pose : poses) {
    way.push_back(pose.world_from_body.translation);
    shifts.push_back(first_m - smooth.at(pose.time.seconds()));
    pose.world_from_body.translation.z() += shifts.back();
  }
  const NearestPoints nearest(way);
  for (MapLandmark& landmark : run->landmarks) {
    landmark.position.z() += shifts[nearest.find(landmark.position, 1).front()];
  }
  const double sigma_m = std::max(scatterAbout(smooth, pairs), profile.resolution_m / std::sqrt(12.0));
  for (PositionUncertainty& uncertainty : run->uncertainties) {
    uncertainty.covariance.row(2).setZero();
    uncertainty.covariance.col(2).setZero();
    uncertainty.covariance(2, 2) = sigma_m * sigma_m;
  }
  return alignment.start_depth_m + first_m;
}

}  // namespace lodeline
