#include "lodeline/estimator/monitoring/image_pose.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "lodeline/factors/intrinsics_factor.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/problem/state/camera_states.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

/// Maximum number of landmarks that are used: more would not make a contradiction clearer.
constexpr int kMostLandmarks = 60;
constexpr int kFewestLandmarks = 12;
/// Number of landmarks of one image that count as independent, because their errors are correlated.
constexpr double kIndependentLandmarks = 10.0;
/// Largest robust scale of the residuals with which the landmarks still agree on a pose, sigmas.
constexpr double kWidestScale = 8.0;

struct Seen {
  Vec3 direction_W;  ///< homogeneous point relative to the host's camera: direction + rho (host - x)
  Vec3 host_W;
  double rho;
  DirectionMeasurement measurement;
};

class Resection {
 public:
  Resection(const Window& window, const FactorBuilder& factors)
      : states_(cameraStates(window)), frame_(window.newest()) {
    const Rigid3 camera_W = factors.worldFromCamera(window, frame_, 0);
    body_from_camera_ = frame_.worldFromBody().inverse() * camera_W;
    const FrameId newest = frame_.id;
    int count = 0;
    for (const auto& [id, track] : window.tracks()) count += isUsed(track, newest);
    const int step = std::max(1, (count + kMostLandmarks - 1) / kMostLandmarks);
    FrameId host_id = -1;
    Rigid3 host_W;
    int i = 0;
    for (const auto& [id, track] : window.tracks()) {
      if (!isUsed(track, newest) || i++ % step != 0) continue;
      if (track.landmark->host != host_id) {
        host_id = track.landmark->host;
        host_W = factors.worldFromCamera(window, *window.find(host_id), 0);
      }
      seen_.push_back({host_W.rotation * track.landmark->base.direction(track.landmark->parameters.data()),
                       host_W.translation, track.landmark->inverseDistance(),
                       atTimeOfImage(*track.find(newest, 0), factors.motionOf(frame_, 0), states_)});
    }
    errors_.resize(seen_.size());
  }

  int count() const { return static_cast<int>(seen_.size()); }

  /// Sum of the squared residuals, each limited, to rank start poses that are far apart.
  double truncatedCost(const Rigid3& world_from_body) {
    constexpr double kCut_sigmas = 20.0;
    double cost = 0.0;
    for (const double error : errorsAt(world_from_body)) cost += std::min(error, kCut_sigmas);
    return cost;
  }

  /// Robust scale of the residuals at a pose: the sigma of the two-dimensional normal distribution with their
  /// median norm.
  double scaleAt(const Rigid3& world_from_body) {
    constexpr double kMedianOfRayleigh = 1.1774;
    return median(errorsAt(world_from_body)) / kMedianOfRayleigh;
  }

  int agreeing(const Rigid3& world_from_body, double within_sigmas) {
    const std::vector<double>& errors = errorsAt(world_from_body);
    return static_cast<int>(
        std::count_if(errors.begin(), errors.end(), [&](double error) { return error < within_sigmas; }));
  }

  /// Gauss-Newton step with Cauchy weights of the given width. Returns the step.
  Eigen::Matrix<double, 6, 1> step(double width_sigmas, const Rigid3& world_from_body, Mat6* hessian) {
    Eigen::Matrix<double, 6, 1> gradient = Eigen::Matrix<double, 6, 1>::Zero();
    hessian->setZero();
    const Rigid3 camera_W = world_from_body * body_from_camera_;
    const Mat3 camera_from_world = camera_W.rotation.toRotationMatrix().transpose();
    for (const Seen& seen : seen_) {
      const Vec3 from_camera_W = seen.direction_W + seen.rho * (seen.host_W - camera_W.translation);
      Mat23 by_point;
      const Vec2 residual = residualOf(seen, camera_from_world * from_camera_W, &by_point);
      const Vec3 from_body_W = seen.direction_W + seen.rho * (seen.host_W - world_from_body.translation);
      Eigen::Matrix<double, 2, 6> jacobian;
      const Mat23 by_world = by_point * camera_from_world;
      jacobian << -seen.rho * by_world, by_world * so3::skew(from_body_W);
      const double weight = 1.0 / (1.0 + residual.squaredNorm() / (width_sigmas * width_sigmas));
      hessian->noalias() += weight * jacobian.transpose() * jacobian;
      gradient.noalias() += weight * jacobian.transpose() * residual;
    }
    // Far points do not determine the position. It is held to a metre, which no step between images reaches.
    hessian->diagonal().array() += 1.0;
    return -hessian->ldlt().solve(gradient);
  }

 private:
  static bool isUsed(const FeatureTrack& track, FrameId newest) {
    return track.landmark && track.landmark->host != newest && track.find(newest, 0);
  }

  Vec2 residualOf(const Seen& seen, const Vec3& point_C, Mat23* by_point) const {
    Vec2 residual =
        directionResidual(seen.measurement, seen.measurement.fromOrigin(point_C, seen.rho), by_point);
    if (!states_.intrinsics.empty())
      residual += intrinsicsShift(seen.measurement, residual, states_.intrinsics.front()->value.data());
    return residual;
  }

  const std::vector<double>& errorsAt(const Rigid3& world_from_body) {
    const Rigid3 camera_W = world_from_body * body_from_camera_;
    const Mat3 camera_from_world = camera_W.rotation.toRotationMatrix().transpose();
    for (size_t i = 0; i < seen_.size(); ++i) {
      const Vec3 from_camera_W =
          seen_[i].direction_W + seen_[i].rho * (seen_[i].host_W - camera_W.translation);
      errors_[i] = residualOf(seen_[i], camera_from_world * from_camera_W, nullptr).norm();
    }
    return errors_;
  }

  CameraStates states_;
  const Frame& frame_;
  Rigid3 body_from_camera_;  ///< at the true time of the images
  std::vector<Seen> seen_;
  std::vector<double> errors_;
};

}  // namespace

std::optional<ImagePose> poseByImages(const Window& window, const FactorBuilder& factors,
                                      std::span<const Rigid3> starts) {
  constexpr int kSteps = 8;
  constexpr double kConverged = 1e-4;  // m and rad
  Resection resection(window, factors);
  ImagePose pose;
  pose.landmarks = resection.count();
  if (pose.landmarks < kFewestLandmarks) return std::nullopt;
  double least = std::numeric_limits<double>::infinity();
  for (const Rigid3& start : starts) {
    if (const double cost = resection.truncatedCost(start); cost < least) {
      least = cost;
      pose.world_from_body = start;
    }
  }
  Mat6 hessian;
  for (int i = 0; i < kSteps; ++i) {
    const double width = 2.0 * std::max(1.0, resection.scaleAt(pose.world_from_body));
    const auto step = resection.step(width, pose.world_from_body, &hessian);
    pose.world_from_body = perturbed(pose.world_from_body, step);
    if (step.norm() < kConverged) break;
  }
  const double scale = std::max(1.0, resection.scaleAt(pose.world_from_body));
  pose.agreeing = resection.agreeing(pose.world_from_body, 3.0 * scale);
  if (scale > kWidestScale || pose.agreeing < kFewestLandmarks || 2 * pose.agreeing < pose.landmarks)
    return std::nullopt;
  const double design_effect = std::max(1.0, pose.agreeing / kIndependentLandmarks);
  pose.covariance = scale * scale * design_effect * hessian.inverse();
  return pose;
}

}  // namespace lodeline
