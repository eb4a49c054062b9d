#include "lodeline/mapping/graph/test_graphs.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>

#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/graph/keyframe_factors.h"
#include "lodeline/mapping/graph/motion/level_motion.h"

namespace lodeline {
namespace {

/// Pose at a place on the circuit: an ellipse of about 150 m, seen along the way, with a rig that rolls.
Rigid3 circuitPose(double place_m) {
  const double angle = 2.0 * std::numbers::pi * place_m / 150.0;
  const Vec3 position(28.0 * std::cos(angle), 19.0 * std::sin(angle), -12.0 + 3.0 * std::sin(2.0 * angle));
  const double azimuth = std::atan2(19.0 * std::cos(angle), -28.0 * std::sin(angle));
  return Rigid3(Quat(Eigen::AngleAxisd(azimuth, Vec3::UnitZ())) *
                    so3::exp(Vec3(0.1 * std::sin(5.0 * angle), 0.1 * std::cos(3.0 * angle), 0.0)),
                position);
}

Vec3 drawnVector(double sigma, std::mt19937_64* generator) {
  return drawn(sigma * sigma * Mat3::Identity(), generator);
}

}  // namespace

Eigen::VectorXd drawn(const Eigen::MatrixXd& covariance, std::mt19937_64* generator) {
  std::normal_distribution<double> normal;
  Eigen::VectorXd white(covariance.rows());
  for (Eigen::Index i = 0; i < white.size(); ++i) white[i] = normal(*generator);
  return Eigen::LLT<Eigen::MatrixXd>(covariance).matrixL() * white;
}

RelativePose withError(const RelativePose& truth, std::mt19937_64* generator) {
  // truth = measured (+) error, so the measured pose is the true one less the error.
  const Vec6 error = drawn(truth.covariance, generator);
  return {Rigid3((so3::exp(-error.tail<3>()) * truth.from_from_to.rotation).normalized(),
                 truth.from_from_to.translation - error.head<3>()),
          truth.covariance};
}

CircuitDive swumCircuit(const GraphCircuitOptions& options, std::mt19937_64* generator) {
  CircuitDive dive{options.dive, options.first_id, {}, {}};
  std::normal_distribution<double> normal;
  // Error [dp, dtheta] of odometry in world axes: true = (exp(dtheta) R, p + dp). Gravity bounds roll and
  // pitch, whose errors forget half of themselves in 35 m.
  const double tilt_variance = std::pow(0.1 * std::numbers::pi / 180.0, 2);
  Vec3 angle_error(std::sqrt(tilt_variance) * normal(*generator),
                   std::sqrt(tilt_variance) * normal(*generator), 0.0);
  Vec3 position_W = Vec3::Zero();
  Mat6 covariance = Mat6::Zero();
  covariance(3, 3) = covariance(4, 4) = tilt_variance;
  for (int k = 0; k < options.keyframes; ++k) {
    const Rigid3 truth = circuitPose(options.first_place + k);
    if (k > 0) {
      const Rigid3& before = dive.truth.back();
      const Vec3 step_B = before.rotation.conjugate() * (truth.translation - before.translation);
      const double path_m = step_B.norm(), kept = std::exp(-path_m / 50.0);
      const double position_sigma = options.position_m_per_sqrt_m * std::sqrt(path_m);
      const double azimuth_sigma = options.rotation_rad_per_sqrt_m * std::sqrt(path_m);
      const double tilt_sigma = std::sqrt(tilt_variance * (1.0 - kept * kept));
      const Vec3 way_W =
          dive.keyframes.back().odom_from_body.rotation * (step_B - drawnVector(position_sigma, generator));
      position_W += way_W;
      angle_error = Vec3(kept * angle_error.x() + tilt_sigma * normal(*generator),
                         kept * angle_error.y() + tilt_sigma * normal(*generator),
                         angle_error.z() + azimuth_sigma * normal(*generator));
      Mat6 carried = Mat6::Identity();
      carried.topRightCorner<3, 3>() = -so3::skew(way_W);
      carried(3, 3) = carried(4, 4) = kept;
      covariance = carried * covariance * carried.transpose();
      covariance.diagonal() +=
          (Vec6() << Vec3::Constant(position_sigma * position_sigma), tilt_sigma * tilt_sigma,
           tilt_sigma * tilt_sigma, azimuth_sigma * azimuth_sigma)
              .finished();
    }
    MapKeyframe keyframe;
    keyframe.id = options.first_id + k;
    keyframe.dive = options.dive;
    keyframe.time = Time::fromSeconds(2.0 * k);
    keyframe.odom_from_body = Rigid3((so3::exp(-angle_error) * truth.rotation).normalized(), position_W);
    keyframe.covariance = covariance;
    dive.truth.push_back(truth);
    dive.keyframes.push_back(keyframe);
  }
  return dive;
}

PoseGraph graphOf(const CircuitDive& dive) {
  PoseGraph graph;
  for (size_t k = 0; k < dive.keyframes.size(); ++k) {
    addKeyframe(dive.keyframes[k], k > 0 ? &dive.keyframes[k - 1] : nullptr, &graph, dive.truth[0]);
  }
  return graph;
}

Mat6 loopCovariance() {
  Vec6 variances;
  variances << Vec3::Constant(0.02 * 0.02), Vec3::Constant(0.0052 * 0.0052);
  return variances.asDiagonal();
}

Loop trueLoop(KeyframeId old_id, const Rigid3& old_pose, KeyframeId new_id, const Rigid3& new_pose,
              std::mt19937_64* generator) {
  Loop loop;
  loop.old_keyframe = old_id;
  loop.new_keyframe = new_id;
  loop.covariance = loopCovariance();
  loop.old_from_new = withError({old_pose.inverse() * new_pose, loop.covariance}, generator).from_from_to;
  return loop;
}

Loop falseLoop(KeyframeId old_id, KeyframeId new_id, std::mt19937_64* generator) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Loop loop;
  loop.old_keyframe = old_id;
  loop.new_keyframe = new_id;
  loop.covariance = loopCovariance();
  const Vec3 position(uniform(*generator), uniform(*generator), 0.3 * uniform(*generator));
  loop.old_from_new = Rigid3(so3::exp(Vec3(0.05, 0.05, 0.35) * uniform(*generator)), position);
  return loop;
}

double alignedRmse_m(const std::vector<Rigid3>& estimate, const std::vector<Rigid3>& truth) {
  Vec3 mean_estimate = Vec3::Zero(), mean_truth = Vec3::Zero();
  const double count = static_cast<double>(truth.size());
  for (size_t i = 0; i < truth.size(); ++i) {
    mean_estimate += estimate[i].translation / count;
    mean_truth += truth[i].translation / count;
  }
  double along = 0.0, across = 0.0;
  for (size_t i = 0; i < truth.size(); ++i) {
    const Vec3 a = estimate[i].translation - mean_estimate, b = truth[i].translation - mean_truth;
    along += a.x() * b.x() + a.y() * b.y();
    across += a.x() * b.y() - a.y() * b.x();
  }
  const Quat turn(Eigen::AngleAxisd(std::atan2(across, along), Vec3::UnitZ()));
  double sum = 0.0;
  for (size_t i = 0; i < truth.size(); ++i) {
    sum += (turn * (estimate[i].translation - mean_estimate) - (truth[i].translation - mean_truth))
               .squaredNorm();
  }
  return std::sqrt(sum / count);
}

}  // namespace lodeline
