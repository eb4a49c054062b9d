#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/mapping/graph/motion/relative_pose.h"
#include "lodeline/mapping/keyframe/map_keyframe.h"

namespace lodeline {

/// Relative pose of two nodes, by odometry or by a loop.
struct GraphEdge {
  KeyframeId from = -1;
  KeyframeId to = -1;
  RelativePose relative;
  /// Whether the solution may refuse it: true for loops, false for odometry.
  bool robust = false;
};

/// Direction of up in a node's body, by accelerometers.
struct TiltMeasurement {
  KeyframeId node = -1;
  Vec3 up_B = Vec3::UnitZ();  ///< unit
  double sigma_rad = 0.0;     ///< about each horizontal axis
};

/// Orientation of a node in a world whose azimuth is the same in the whole dive, up to noise: the odometry's
/// with a magnetometer. That azimuth is a parameter of the dive (AzimuthPrior).
struct HeadingMeasurement {
  KeyframeId node = -1;
  Quat odom_from_body = Quat::Identity();
  double sigma_rad = 0.0;  ///< independent of other nodes
};

/// Azimuth of a dive's odometry world in the world of the graph, known before. Its error is common to all
/// headings of the dive.
struct AzimuthPrior {
  int dive = 0;
  double azimuth_rad = 0.0;
  double sigma_rad = 0.0;
};

/// Height of a node in the world of its dive's odometry, which has used the pressure sensor. Heights in the
/// world of the graph differ by an offset, a parameter of the dive: measured = true + offset.
struct HeightMeasurement {
  KeyframeId node = -1;
  double height_m = 0.0;
  double sigma_m = 0.0;  ///< independent of other nodes
};

/// Depth of the origin of a dive's odometry below the surface of the water. The surface is that of all dives
/// of a graph; its height is a parameter.
struct OriginDepth {
  int dive = 0;
  double depth_m = 0.0;
  double sigma_m = 0.0;
};

/// Height of the surface of the water in the world of the graph, known before.
struct SurfaceHeight {
  double height_m = 0.0;
  double sigma_m = 0.0;
};

/// A point fixed in a node's body at a measured position: a GPS fix or a surveyed station.
struct PositionMeasurement {
  std::string name;
  KeyframeId node = -1;
  Vec3 position_W = Vec3::Zero();      ///< measured, m
  Mat3 covariance = Mat3::Identity();  ///< in world axes, m^2
  Vec3 point_B = Vec3::Zero();         ///< the point in the body, m
  bool robust = true;
};

/// A point with identity that nodes see: a tag or a mark. A measured position is optional.
struct GraphLandmark {
  std::string name;
  std::optional<Vec3> position_W;      ///< measured, m
  Mat3 covariance = Mat3::Identity();  ///< of the measured position, m^2
};

/// A landmark seen from a node.
struct LandmarkObservation {
  std::string landmark;
  KeyframeId node = -1;
  Vec3 point_B = Vec3::Zero();         ///< measured in the body, m
  Mat3 covariance = Mat3::Identity();  ///< in body axes, m^2
  bool robust = true;
};

/// Identifies a robust factor of a graph in the order in which they were added: 0, 1, 2, ...
using RobustIndex = int;

/// What became of a factor that could be refused, or of a control point.
struct FactorReport {
  enum class Kind { Loop, Position, LandmarkObservation } kind = Kind::Loop;
  std::string name;        ///< of the control point or the landmark; empty for loops
  KeyframeId from = -1;    ///< the node of a position or observation
  KeyframeId to = -1;      ///< of loops
  bool is_robust = true;   ///< false: it could not be refused
  double weight = 1.0;     ///< 1 used, 0 not used
  double chi_squared = 0;  ///< of its residual at the solution, whether it was used or not
  int degrees_of_freedom = 6;
  /// Residual at the solution without whitening: [dp, dtheta] in axes of `from` for loops, m in world axes
  /// for positions, m in body axes for observations.
  Eigen::VectorXd residual;
  bool accepted = true;
  std::string reason;  ///< why it was refused, in words
};

struct GraphSummary {
  bool converged = false;
  int rounds = 0;                     ///< least-squares problems solved
  int iterations = 0;                 ///< steps of all of these
  double cost = 0.0;                  ///< half the sum of chi^2 of everything that was used
  std::vector<FactorReport> factors;  ///< loops, positions and observations in the order of addition

  int acceptedLoops() const;
  int refusedLoops() const;
};

}  // namespace lodeline
