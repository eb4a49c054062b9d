#pragma once

#include "lodeline/mapping/graph/motion/odometry_edge.h"
#include "lodeline/mapping/graph/pose_graph.h"

namespace lodeline {

/// What a dive's keyframes contribute to a graph.
struct KeyframeFactorOptions {
  OdometryFloor odometry;
  /// Least sigma of roll and pitch, rad: 0.3 degrees, which accelerometers of small rigs hold over a dive.
  double least_tilt_sigma_rad = 0.0052;
  /// Part of the variance of a dive's best heading that is not common to the whole dive. The rest is: hard
  /// iron, misalignment, declination.
  double independent_heading_share = 0.1;
  /// Sigma of the angle between the north of the dive's headings and the y axis of the graph's world, rad.
  double north_sigma_rad = 0.0;
  /// Error of a dive's depths that is common to all of them, m: air pressure and water level. That of the
  /// density is part of their sigma.
  double common_depth_sigma_m = 0.1;
  /// Least sigma of a height, m: slow errors of a pressure sensor.
  double least_height_sigma_m = 0.01;

  void check() const;
};

/// Adds a keyframe and what it knows of itself: a node, the odometry from the previous keyframe of its dive
/// (null for the first one), roll and pitch, heading and depth. The first keyframe of a dive also adds the
/// prior of the dive's azimuth and the depth of its origin where it has heading and depth. The pose of a
/// first keyframe is `first_world_from_odom` times its odometry; later ones follow the previous node's
/// estimate.
///
/// The headings of two neighbours have mostly the same error, and so do their heights. A keyframe therefore
/// adds only what its heading tells beyond the previous heading and the turn since, and its height beyond the
/// previous height and the rise since. s_i^2 are the variances of the headings without their common part, or
/// those of the heights, and q is that of the turn or the rise. The variance r of what is added is
///   1 / r = 1 / s_i^2 - 1 / (s_{i-1}^2 + q).
/// All values up to i together then have the variance s_i^2. Where s_i^2 is not below s_{i-1}^2 + q, the
/// value was only carried on, and nothing is added.
void addKeyframe(const MapKeyframe& keyframe, const MapKeyframe* previous, PoseGraph* graph,
                 const Rigid3& first_world_from_odom = {}, const KeyframeFactorOptions& options = {});

/// The loop as a robust edge.
GraphEdge edgeOf(const Loop& loop);

}  // namespace lodeline
