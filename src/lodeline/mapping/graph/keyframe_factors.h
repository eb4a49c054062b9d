#pragma once

#include "lodeline/mapping/graph/motion/odometry_edge.h"
#include "lodeline/mapping/graph/pose_graph.h"

namespace lodeline {

/// What a dive's keyframes contribute to a graph.
struct KeyframeFactorOptions {
  OdometryFloor odometry;
  /// Least sigma of roll and pitch, rad: 0.3 degrees, which accelerometers of small rigs hold over a dive.
  double least_tilt_sigma_rad = 0.0052;
  /// Part of the heading error at a keyframe that is independent of other keyframes, of the whole variance.
  /// The rest is common to the dive: hard iron, misalignment, declination.
  double independent_heading_share = 0.1;
  /// Error of a dive's depths that is common to all of them: air pressure and water level, m.
  double height_offset_sigma_m = 0.1;

  void check() const;
};

/// Adds a keyframe and what it knows of itself: a node, the odometry from the previous keyframe of its dive
/// (null for the first one), roll and pitch, heading and depth. The first keyframe of a dive also adds the
/// priors of the dive's azimuth and height offset where it has heading and depth. The pose of a first
/// keyframe is `first_world_from_odom` times its odometry; later ones follow the previous node's estimate.
void addKeyframe(const MapKeyframe& keyframe, const MapKeyframe* previous, PoseGraph* graph,
                 const Rigid3& first_world_from_odom = {}, const KeyframeFactorOptions& options = {});

/// The loop as a robust edge.
GraphEdge edgeOf(const Loop& loop);

}  // namespace lodeline
