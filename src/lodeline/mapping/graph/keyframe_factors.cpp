#include "lodeline/mapping/graph/keyframe_factors.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

void checkSigma(double sigma, const MapKeyframe& keyframe, const char* what) {
  if (sigma > 0.0 && std::isfinite(sigma)) return;
  throw InputError(fmt::format("keyframe {}: sigma of the {} is {:g}", keyframe.id, what, sigma));
}

TiltMeasurement tiltOf(const MapKeyframe& keyframe, double least_sigma_rad) {
  const Mat2 covariance = keyframe.covariance.block<2, 2>(3, 3);
  const double variance = Eigen::SelfAdjointEigenSolver<Mat2>(covariance).eigenvalues().maxCoeff();
  return {keyframe.id, keyframe.odom_from_body.rotation.conjugate() * Vec3::UnitZ(),
          std::max(least_sigma_rad, std::sqrt(std::max(variance, 0.0)))};
}

/// Variance along up of a 3 x 3 covariance in axes of a keyframe's body.
double varianceAlongUp(const MapKeyframe& keyframe, const Mat3& covariance_B) {
  const Vec3 up_B = keyframe.odom_from_body.rotation.conjugate() * Vec3::UnitZ();
  return up_B.dot(covariance_B * up_B);
}

/// Variance of what a value adds to the value before it and the odometry since; see addKeyframe().
/// `predicted`: its variance by these two. Empty where it adds nothing.
std::optional<double> addedVariance(double variance, double predicted) {
  if (variance >= predicted) return std::nullopt;
  return variance * predicted / (predicted - variance);
}

/// `odometry`: from the previous keyframe, null for the first one of a dive.
void addHeading(const MapKeyframe& keyframe, const MapKeyframe* previous, const RelativePose* odometry,
                const KeyframeFactorOptions& options, PoseGraph* graph) {
  const double sigma = *keyframe.heading_sigma_rad;
  checkSigma(sigma, keyframe, "heading");
  const double north_variance = std::pow(options.north_sigma_rad, 2);
  const double azimuth_sigma =
      std::sqrt((1.0 - options.independent_heading_share) * sigma * sigma + north_variance);
  // The azimuth of the dive is known as well as at its best keyframe.
  const std::optional<double> known_sigma = graph->azimuthSigma(keyframe.dive);
  if (!known_sigma || azimuth_sigma < *known_sigma) {
    graph->add(AzimuthPrior{keyframe.dive, 0.0, azimuth_sigma});
  }
  const double common_variance = std::pow(*graph->azimuthSigma(keyframe.dive), 2) - north_variance;
  std::optional<double> variance = sigma * sigma - common_variance;
  if (odometry && previous->heading_sigma_rad) {
    const double turn_variance = varianceAlongUp(*previous, odometry->covariance.bottomRightCorner<3, 3>());
    variance =
        addedVariance(*variance, std::pow(*previous->heading_sigma_rad, 2) - common_variance + turn_variance);
    if (!variance) return;
  }
  const Quat north_from_odom = so3::exp(keyframe.north_from_odom_rad * Vec3::UnitZ());
  graph->add(HeadingMeasurement{keyframe.id, north_from_odom * keyframe.odom_from_body.rotation,
                                std::sqrt(*variance)});
}

double heightVariance(const MapKeyframe& keyframe, const KeyframeFactorOptions& options) {
  return std::max(keyframe.covariance(2, 2), std::pow(options.least_height_sigma_m, 2));
}

void addHeight(const MapKeyframe& keyframe, const MapKeyframe* previous, const RelativePose* odometry,
               const KeyframeFactorOptions& options, PoseGraph* graph) {
  std::optional<double> variance = heightVariance(keyframe, options);
  if (odometry && previous->depth_m) {
    const double rise_variance = varianceAlongUp(*previous, odometry->covariance.topLeftCorner<3, 3>());
    variance = addedVariance(*variance, heightVariance(*previous, options) + rise_variance);
  }
  if (variance)
    graph->add(HeightMeasurement{keyframe.id, keyframe.odom_from_body.translation.z(), std::sqrt(*variance)});
}

void addOriginDepth(const MapKeyframe& keyframe, const KeyframeFactorOptions& options, PoseGraph* graph) {
  checkSigma(keyframe.depth_m->sigma, keyframe, "depth");
  // The depth of the dive is known as well as at its best keyframe.
  const double sigma_m = std::hypot(options.common_depth_sigma_m, keyframe.depth_m->sigma);
  const std::optional<double> known_sigma_m = graph->originDepthSigma(keyframe.dive);
  if (known_sigma_m && *known_sigma_m <= sigma_m) return;
  graph->add(
      OriginDepth{keyframe.dive, keyframe.depth_m->value + keyframe.odom_from_body.translation.z(), sigma_m});
}

}  // namespace

void KeyframeFactorOptions::check() const {
  odometry.check();
  if (!(least_tilt_sigma_rad > 0.0)) throw UsageError("the least sigma of roll and pitch must be positive");
  if (!(independent_heading_share > 0.0 && independent_heading_share < 1.0)) {
    throw UsageError("the independent share of heading errors must lie between 0 and 1");
  }
  if (!(north_sigma_rad >= 0.0)) throw UsageError("sigma of the north must not be negative");
  if (!(common_depth_sigma_m > 0.0)) throw UsageError("the common sigma of depths must be positive");
  if (!(least_height_sigma_m > 0.0)) throw UsageError("the least sigma of a height must be positive");
}

void addKeyframe(const MapKeyframe& keyframe, const MapKeyframe* previous, PoseGraph* graph,
                 const Rigid3& first_world_from_odom, const KeyframeFactorOptions& options) {
  options.check();
  checkPose(keyframe.odom_from_body, fmt::format("keyframe {}", keyframe.id).c_str());
  if (!keyframe.covariance.allFinite()) {
    throw InputError(fmt::format("keyframe {}: the covariance of its odometry is not finite", keyframe.id));
  }
  std::optional<RelativePose> odometry;
  if (previous) {
    odometry = odometryFactor(*previous, keyframe, options.odometry);
    graph->addNode(keyframe.id, keyframe.dive, graph->pose(previous->id) * odometry->from_from_to);
    graph->add(GraphEdge{previous->id, keyframe.id, *odometry, false});
  } else {
    graph->addNode(keyframe.id, keyframe.dive, first_world_from_odom * keyframe.odom_from_body);
  }
  graph->add(tiltOf(keyframe, options.least_tilt_sigma_rad));
  const RelativePose* since_previous = odometry ? &*odometry : nullptr;
  if (keyframe.heading_sigma_rad) addHeading(keyframe, previous, since_previous, options, graph);
  if (!keyframe.depth_m) return;
  addHeight(keyframe, previous, since_previous, options, graph);
  addOriginDepth(keyframe, options, graph);
}

GraphEdge edgeOf(const Loop& loop) {
  return {loop.old_keyframe, loop.new_keyframe, {loop.old_from_new, loop.covariance}, true};
}

}  // namespace lodeline
