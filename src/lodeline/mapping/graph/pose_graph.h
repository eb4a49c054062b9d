#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "lodeline/mapping/graph/graph_covariance.h"
#include "lodeline/mapping/graph/graph_elements.h"

namespace lodeline {

class GraphProblem;

struct PoseGraphOptions {
  /// Probability with which a true robust factor is kept: 3 sigma. Beyond that chi^2 it is refused.
  double inlier_probability = 0.9973;
  int most_iterations = 50;  ///< of one least-squares problem

  void check() const;
};

/// Poses of keyframes of one or many dives, connected by measurements, and their least-squares estimate with
/// loops and control points that may be false.
///
/// The world W has z up. Measurements of position, north and depth determine its origin and azimuth. What
/// they leave open is held at the first node: its horizontal position, height, azimuth, or roll and pitch.
/// Every other part without a certain connection (a dive that only loops join) has a weak prior of 1 km and
/// 10 rad at its first node; the result stays defined where all its loops are refused.
///
/// RobustSolution decides which robust factors are used. A solution starts from the last one: where new loops
/// agree with it, they are added. Where any is refused, all begins anew from the odometry.
///
/// The result depends on the input and its order only (one thread). Errors of input throw InputError.
class PoseGraph {
 public:
  explicit PoseGraph(const PoseGraphOptions& options = {});
  ~PoseGraph();
  PoseGraph(PoseGraph&&) noexcept;
  PoseGraph& operator=(PoseGraph&&) noexcept;

  /// Adds a node with its initial pose.
  void addNode(KeyframeId id, int dive, const Rigid3& world_from_body);
  void add(const GraphEdge& edge);
  void add(const TiltMeasurement& measurement);
  void add(const HeadingMeasurement& measurement);
  void add(const HeightMeasurement& measurement);
  void add(const PositionMeasurement& measurement);
  void add(const GraphLandmark& landmark);
  void add(const LandmarkObservation& observation);
  /// A later one, or one of the same dive, replaces an earlier one. Without one, its number is free.
  void add(const AzimuthPrior& prior);
  void add(const OriginDepth& depth);
  void add(const SurfaceHeight& surface);

  /// Estimates all nodes. Throws EstimationError where the solver fails.
  GraphSummary solve();

  bool contains(KeyframeId id) const;
  size_t size() const;
  Rigid3 pose(KeyframeId id) const;              ///< world_from_body
  std::map<KeyframeId, Rigid3> poses() const;    ///< world_from_body
  Vec3 landmark(const std::string& name) const;  ///< position in W, m
  double azimuth(int dive) const;                ///< of the dive's odometry world in W, rad
  double heightOffset(int dive) const;           ///< m
  double surfaceHeight() const;                  ///< of the water in W, m; 0 without any depth

  /// Sigma of the azimuth prior of a dive, rad; empty without one.
  std::optional<double> azimuthSigma(int dive) const;
  /// Sigma of the depth of a dive's origin, m; empty without one.
  std::optional<double> originDepthSigma(int dive) const;

  /// Covariances at the present estimate. The factorization is done once here; each request then solves for
  /// the columns of the nodes it names. Throws EstimationError where the graph is not determined.
  GraphCovariance covariance() const;

 private:
  PoseGraphOptions options_;
  bool was_solved_ = false;
  std::unique_ptr<GraphProblem> problem_;
};

}  // namespace lodeline
