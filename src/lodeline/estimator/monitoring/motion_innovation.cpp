#include "lodeline/estimator/monitoring/motion_innovation.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>

#include "lodeline/estimator/monitoring/image_pose.h"
#include "lodeline/factors/parameters.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

/// Relative error of the translation and of the rotation since the frame before, one sigma. It covers
/// distances of landmarks, axes of sensors and extrinsics that are still being estimated.
constexpr double kWayError = 0.05;
constexpr double kTurnError = 0.02;

/// Constant motion of the body into the frame before the newest, from the estimates of that frame and of its
/// predecessor. The last readings of that interval are not used, because they may already be wrong. At rest
/// where there is no such frame.
ImageMotion steadyMotion(const Window& window) {
  const auto& frames = window.frames();
  if (frames.size() < 3) return {};
  const Frame &from = *frames[frames.size() - 3], &to = *frames[frames.size() - 2];
  const double dt_s = (to.time - from.time).seconds();
  const Rigid3 world_from_begin = from.worldFromBody(), world_from_end = to.worldFromBody();
  return {(world_from_end.translation - world_from_begin.translation) / dt_s,
          so3::log(world_from_begin.rotation.conjugate() * world_from_end.rotation) / dt_s};
}

/// Covariance of the predicted [dp, dtheta] relative to the frame before, world axes. `of_new`: by the noise
/// of the readings. `of_lasting`: by the error of the state.
struct PredictionCovariance {
  Mat6 of_new, of_lasting;
};

PredictionCovariance predictionCovariance(const Frame& before, const Preintegration& interval,
                                          const Eigen::Matrix<double, 15, 15>& known, bool is_before_placed) {
  using namespace inertial_error;
  const double dt_s = interval.dt_s();
  const Mat3 world_from_before = before.worldFromBody().rotation.toRotationMatrix();
  Eigen::Matrix<double, 6, 9> by_motion = Eigen::Matrix<double, 6, 9>::Zero();
  by_motion.block<3, 3>(0, kAlpha) = world_from_before;
  by_motion.block<3, 3>(3, kTheta) = world_from_before;
  // A rotation of the frame before also rotates its velocity: relative to that frame the velocity stays
  // constant.
  Eigen::Matrix<double, 6, 15> by_state = Eigen::Matrix<double, 6, 15>::Zero();
  if (is_before_placed) {
    by_state.block<3, 3>(0, 3) = dt_s * so3::skew(before.velocity_W());
  } else {
    by_state.leftCols<6>().setIdentity();
  }
  by_state.block<3, 3>(0, 6).diagonal().setConstant(dt_s);
  by_state.rightCols<6>() = by_motion * interval.biasJacobian();
  return {by_motion * interval.covariance().topLeftCorner<9, 9>() * by_motion.transpose(),
          by_state * known * by_state.transpose()};
}

}  // namespace

double Innovation::nis() const {
  return value.dot((covariance_of_new + covariance_of_lasting).ldlt().solve(value)) / 3.0;
}

std::optional<MotionInnovation> motionInnovation(Window& window, const FactorBuilder& factors,
                                                 const Eigen::Matrix<double, 15, 15>& before,
                                                 bool is_before_placed) {
  Frame& newest = window.newest();
  const Frame& previous = *window.frames()[window.frames().size() - 2];
  const Preintegration& interval = *newest.from_previous;
  const double dt_s = interval.dt_s();
  const Rigid3 predicted = newest.worldFromBody();
  // The rate of a wrong reading must not move the camera within the time offset of the images.
  const ImageMotion steady = steadyMotion(window);
  newest.image_motion = steady;
  const std::array<Rigid3, 3> starts = {predicted, steady.poseAfter(previous.worldFromBody(), dt_s),
                                        previous.worldFromBody()};
  const std::optional<ImagePose> seen = poseByImages(window, factors, starts);
  if (!seen) return std::nullopt;

  MotionInnovation innovation;
  innovation.interval_s = dt_s;
  innovation.world_from_body = seen->world_from_body;
  const auto from_prediction = perturbationBetween(predicted, seen->world_from_body);
  const auto from_steady = perturbationBetween(starts[1], seen->world_from_body);
  innovation.position_from_steady_W = from_steady.head<3>();
  innovation.rotation_from_steady_W = from_steady.tail<3>();

  const auto step = perturbationBetween(previous.worldFromBody(), seen->world_from_body);
  PredictionCovariance covariance = predictionCovariance(previous, interval, before, is_before_placed);
  // The frame before has a pose by an image of about the same accuracy.
  covariance.of_new += 2.0 * seen->covariance;
  covariance.of_lasting.diagonal().head<3>().array() += kWayError * kWayError * step.head<3>().squaredNorm();
  covariance.of_lasting.diagonal().tail<3>().array() +=
      kTurnError * kTurnError * step.tail<3>().squaredNorm();
  innovation.position_W = {from_prediction.head<3>(), covariance.of_new.topLeftCorner<3, 3>(),
                           covariance.of_lasting.topLeftCorner<3, 3>()};
  innovation.rotation_W = {from_prediction.tail<3>(), covariance.of_new.bottomRightCorner<3, 3>(),
                           covariance.of_lasting.bottomRightCorner<3, 3>()};
  return innovation;
}

}  // namespace lodeline
