#pragma once

#include <string>

#include "lodeline/mapping/cloud/local_cloud.h"
#include "lodeline/mapping/keyframe/map_keyframe.h"

namespace lodeline {

/// Settings of a registration. Every limit refuses; none makes a result better.
struct CloudRegistrationOptions {
  int neighbours = 10;           ///< whose plane is the old surface at a point
  double start_spacing_m = 0.6;  ///< of the starts; the basin of a passage of 1 m radius is wider
  int most_starts = 81;          ///< a wider prior is refused
  /// Least share of the new points with a counterpart on the old surface, either way.
  double least_counterpart_share = 0.4;
  /// Largest usual error of the fit, by that of each cloud within itself (usualErrorWithin). The same wall
  /// has about 0.6, because a whole surface is more accurate than half of it.
  double most_usual_error = 0.85;
  /// A mirrored cloud has the size and the slopes of the passage, but not its shape. The score of the cloud
  /// itself must be lower than that of the best mirrored one by this factor.
  double most_score_of_mirrored = 0.6;
  /// Parameters that are not estimated: relative scale of the distances of each cloud, and tilt of each.
  double scale_sigma = 0.01;
  double tilt_sigma_rad = 0.005;
  /// Relative drift of odometry over a few metres. Drift of 0.3 % over 220 m that keeps its direction for 20
  /// m is this much locally: 0.3 % times the root of half the number of such lengths.
  double local_drift = 0.0075;

  /// Throws UsageError for values that make no sense.
  void check() const;
};

/// What the shapes of two clouds say about their relative pose.
struct CloudRegistration {
  /// The row for the ledger and the graph, of source "cloud". Verified, or Refused with the reason. Its
  /// covariance has the prior's times `kUnobservedFactor` along directions that the shape does not observe.
  Loop loop;
  /// Of [dp, dtheta] in axes of the old frame. Exactly zero along directions that the shape does not observe.
  Mat6 information = Mat6::Zero();
  int observed_directions = 0;        ///< of the four: position of the centroid and yaw
  double information_share = 0.0;     ///< lowest share of the slope that is not noise, of observed directions
  double mirrored_score_ratio = 0.0;  ///< score by that of the best mirrored cloud
};

/// A graph adds a loop to what it knows by odometry. The prior must not count twice: where the shape says
/// nothing, the loop's covariance is a hundred times the prior's sigma, squared.
constexpr double kUnobservedFactor = 1e4;

/// Registers the new cloud to the old one: point to plane, with known gravity. `old_from_new` is the
/// predicted pose of the new frame in the old one, `covariance` that of its [dp, dtheta] in old axes.
/// docs/theory/cloud-registration.md describes the method. Throws InputError for a prediction that is not
/// finite or a covariance that is not positive definite.
CloudRegistration registerClouds(const LocalCloud& old_cloud, const LocalCloud& new_cloud,
                                 const Rigid3& old_from_new, const Mat6& covariance,
                                 const CloudRegistrationOptions& options = {});

}  // namespace lodeline
