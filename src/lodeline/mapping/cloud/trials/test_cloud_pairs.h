#pragma once

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <random>

#include "lodeline/geometry/so3.h"
#include "lodeline/geometry/squared.h"
#include "lodeline/mapping/cloud/register_clouds.h"
#include "lodeline/mapping/cloud/trials/test_tube.h"

namespace lodeline::test {

using Vec6 = Eigen::Matrix<double, 6, 1>;

/// The cloud around a place of a passage, seen on the way in or out, and its true pose. Odometry drifts by
/// `drift` metres a metre.
struct PlacedCloud {
  LocalCloud cloud;
  Rigid3 world_from_frame;
};

inline PlacedCloud cloudAt(const TubeWorld& world, double along_m, bool looks_back, const TubeNoise& noise,
                           std::mt19937_64& random, const Vec3& drift = Vec3::Zero()) {
  constexpr double kHalf_m = 9.0;
  const auto moved = [&](const Rigid3& pose, double path_m) {
    return Rigid3(pose.rotation, pose.translation + (path_m - kHalf_m) * drift);
  };
  const double before_m = looks_back ? along_m + kHalf_m : along_m - kHalf_m;
  const auto keyframes = swim(world, before_m, 2.0 * along_m - before_m, noise, random, moved);
  const size_t middle = keyframes.size() / 2;
  return {cloudOfKeyframes(keyframes, middle), keyframes[middle].odom_from_body};
}

/// What odometry knows of a pair: sigmas of the horizontal position, height and yaw. The pose is that of
/// bodies whose y axis points down.
struct Drift {
  double horizontal_m = 0.3;
  double height_m = 0.05;
  double yaw_rad = 0.03;
};

inline Mat6 covarianceOf(const Drift& drift) {
  Vec6 variances;
  variances << squared(drift.horizontal_m), squared(drift.height_m), squared(drift.horizontal_m), 1e-6,
      squared(drift.yaw_rad), 1e-6;
  return variances.asDiagonal();
}

inline Rigid3 drifted(Rigid3 pose, const Drift& drift, std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  pose.translation += Vec3(drift.horizontal_m * normal(random), drift.height_m * normal(random),
                           drift.horizontal_m * normal(random));
  pose.rotation = (so3::exp(Vec3(0.0, drift.yaw_rad * normal(random), 0.0)) * pose.rotation).normalized();
  return pose;
}

/// Error [dp, dtheta] of a registration.
inline Vec6 errorOf(const CloudRegistration& registration, const Rigid3& truth) {
  Vec6 error;
  error << truth.translation - registration.loop.old_from_new.translation,
      so3::log(truth.rotation * registration.loop.old_from_new.rotation.conjugate());
  return error;
}

/// Squared error in the directions that the registration claims to know, in claimed sigmas.
inline double claimedError(const CloudRegistration& registration, const Rigid3& truth) {
  const Vec6 error = errorOf(registration, truth);
  return error.dot(registration.information * error);
}

/// Largest error along a principal direction of the information, in claimed sigmas.
inline double worstError(const CloudRegistration& registration, const Rigid3& truth) {
  const Eigen::SelfAdjointEigenSolver<Mat6> solver(registration.information);
  const Vec6 error = errorOf(registration, truth);
  double worst = 0.0;
  for (int i = 0; i < 6; ++i) {
    const double information = solver.eigenvalues()[i];
    if (information < 1e-9 * solver.eigenvalues()[5]) continue;
    worst = std::max(worst, std::abs(solver.eigenvectors().col(i).dot(error)) * std::sqrt(information));
  }
  return worst;
}

}  // namespace lodeline::test
