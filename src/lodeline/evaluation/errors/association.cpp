#include "lodeline/trajectory.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/errors/pose_convention.h"

namespace lodeline {
namespace {

using Poses = std::vector<StampedPose>;

/// Index of the first pose not before `time`.
std::size_t lowerBound(const Poses& poses, Time time) {
  const auto found = std::lower_bound(poses.begin(), poses.end(), time,
                                      [](const StampedPose& pose, Time t) { return pose.time < t; });
  return static_cast<std::size_t>(found - poses.begin());
}

int64_t distanceNs(Time a, Time b) { return std::abs((a - b).nanoseconds()); }

std::size_t nearest(const Poses& poses, Time time) {
  const std::size_t after = lowerBound(poses, time);
  if (after == 0) return 0;
  if (after == poses.size()) return after - 1;
  return distanceNs(poses[after].time, time) < distanceNs(poses[after - 1].time, time) ? after : after - 1;
}

struct Match {
  std::size_t few = 0;
  std::size_t many = 0;
  int64_t distance_ns = 0;
};

/// For each of `few` the nearest of `many` within the tolerance; each of `many` is used at most once.
std::vector<Match> matchNearest(const Poses& few, const Poses& many, Duration many_minus_few,
                                Duration tolerance) {
  std::vector<Match> matches;
  for (std::size_t i = 0; i < few.size(); ++i) {
    const Time wanted = few[i].time + many_minus_few;
    const std::size_t j = nearest(many, wanted);
    const Match match{i, j, distanceNs(many[j].time, wanted)};
    if (match.distance_ns > tolerance.nanoseconds()) continue;
    if (!matches.empty() && matches.back().many == j) {
      if (match.distance_ns < matches.back().distance_ns) matches.back() = match;
    } else {
      matches.push_back(match);
    }
  }
  return matches;
}

PosePairs pairNearest(const Poses& estimate, const Poses& reference, Duration offset, Duration tolerance) {
  const bool estimate_chooses = estimate.size() <= reference.size();
  const auto matches = estimate_chooses ? matchNearest(estimate, reference, offset, tolerance)
                                        : matchNearest(reference, estimate, -offset, tolerance);
  PosePairs pairs;
  for (const Match& match : matches) {
    const StampedPose& from_estimate = estimate[estimate_chooses ? match.few : match.many];
    const StampedPose& from_reference = reference[estimate_chooses ? match.many : match.few];
    pairs.time.push_back(from_reference.time);
    pairs.estimate.push_back(from_estimate.world_from_body);
    pairs.reference.push_back(from_reference.world_from_body);
  }
  return pairs;
}

PosePairs pairInterpolated(const Poses& estimate, const Poses& reference, Duration offset,
                           Duration tolerance) {
  PosePairs pairs;
  for (const StampedPose& pose : estimate) {
    const Time time = pose.time + offset;
    const std::size_t after = lowerBound(reference, time);
    if (after == reference.size()) continue;
    const StampedPose& right = reference[after];
    // An exact match needs no left neighbour.
    const StampedPose& left = right.time == time ? right : reference[after == 0 ? 0 : after - 1];
    if (left.time > time || time - left.time > tolerance || right.time - time > tolerance) continue;
    const double span_s = (right.time - left.time).seconds();
    const double share = span_s > 0.0 ? (time - left.time).seconds() / span_s : 0.0;
    const Vec3 position_m = left.world_from_body.translation +
                            share * (right.world_from_body.translation - left.world_from_body.translation);
    pairs.time.push_back(time);
    pairs.estimate.push_back(pose.world_from_body);
    pairs.reference.emplace_back(left.world_from_body.rotation.slerp(share, right.world_from_body.rotation),
                                 position_m);
  }
  return pairs;
}

[[noreturn]] void failNothingMatches(const Trajectory& estimate, const Trajectory& reference,
                                     double tolerance_s) {
  throw InputError(fmt::format(
      "no pose of {} ({:.3f} s to {:.3f} s) has a partner within {} s in {} ({:.3f} s to {:.3f} s); {}",
      estimate.name, estimate.poses.front().time.seconds(), estimate.poses.back().time.seconds(), tolerance_s,
      reference.name, reference.poses.front().time.seconds(), reference.poses.back().time.seconds(),
      differenceOfClocks(estimate, reference)));
}

}  // namespace

PosePairs associate(const Trajectory& estimate, const Trajectory& reference,
                    const AssociationOptions& options) {
  if (estimate.time_base != reference.time_base) {
    const Trajectory& timeless = estimate.time_base == TimeBase::Index ? estimate : reference;
    throw InputError(timeless.name +
                     ": has no times while the other trajectory has; give both with times or both "
                     "without (KITTI rows)");
  }
  const bool by_index = estimate.time_base == TimeBase::Index;
  if (by_index && estimate.rows != reference.rows && estimate.rows != 0 && reference.rows != 0) {
    throw InputError(
        fmt::format("{} has {} rows without times and {} has {}; which row belongs to which is not known. "
                    "Give trajectories "
                    "with times, or only the rows that belong together",
                    estimate.name, estimate.rows, reference.name, reference.rows));
  }
  const Duration tolerance = Duration::fromSeconds(by_index ? 0.0 : options.tolerance_s);
  const Duration offset = Duration::fromSeconds(options.time_offset_s);
  const bool interpolate = options.method == AssociationMethod::Interpolate && !by_index;
  PosePairs pairs = interpolate ? pairInterpolated(estimate.poses, reference.poses, offset, tolerance)
                                : pairNearest(estimate.poses, reference.poses, offset, tolerance);
  if (pairs.size() == 0) failNothingMatches(estimate, reference, tolerance.seconds());
  return pairs;
}

}  // namespace lodeline
