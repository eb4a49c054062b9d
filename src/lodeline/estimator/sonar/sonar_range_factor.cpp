#include "lodeline/estimator/sonar/sonar_range_factor.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "lodeline/diagnostics.h"
#include "lodeline/factors/calibrated_reprojection_factor.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

/// Adds to a row of derivatives; nothing where the block's derivatives are not wanted.
template <int kSize>
void addTo(double* row, const Eigen::Matrix<double, 1, kSize>& derivatives) {
  if (row) Eigen::Map<Eigen::Matrix<double, 1, kSize>>(row) += derivatives;
}

Eigen::Matrix<double, 1, 6> joined(const Eigen::RowVector3d& first, const Eigen::RowVector3d& second) {
  return (Eigen::Matrix<double, 1, 6>() << first, second).finished();
}

}  // namespace

/// The blocks' values, and each landmark in the axes of the beam.
struct SonarRangeFactor::Geometry {
  Rigid3 pose;
  std::vector<Rigid3> hosts;
  Rigid3 camera;
  std::vector<Vec3> q;
  std::vector<double> rho;
  std::vector<BeamPoint> points;
};

SonarRangeFactor::SonarRangeFactor(double range_m, double sigma_m, const SonarBeam& beam,
                                   const Rigid3& body_from_camera, bool is_camera_estimated, size_t hosts,
                                   std::vector<SurfaceLandmark> landmarks,
                                   SonarLinearizationPoints linearization_points)
    : range_m_(range_m),
      sigma_m_(sigma_m),
      beam_(beam),
      body_from_camera_(body_from_camera),
      is_camera_estimated_(is_camera_estimated),
      hosts_(hosts),
      landmarks_(std::move(landmarks)),
      first_(std::move(linearization_points)) {
  constexpr size_t kLeastLandmarks = 3;
  if (!std::isfinite(range_m) || !(range_m > 0.0) || !std::isfinite(sigma_m) || !(sigma_m > 0.0) ||
      landmarks_.size() < kLeastLandmarks) {
    throw InputError(fmt::format("a sonar range of {} m with sigma {} m to {} landmarks cannot be weighed",
                                 range_m, sigma_m, landmarks_.size()));
  }
  set_num_residuals(1);
  std::vector<int32_t>& sizes = *mutable_parameter_block_sizes();
  sizes.assign(1 + hosts_, kPoseSize);
  if (is_camera_estimated_) sizes.push_back(kExtrinsicsSize);
  sizes.insert(sizes.end(), landmarks_.size(), kLandmarkSize);
  first_.hosts.resize(hosts_, nullptr);
}

SonarRangeFactor::Geometry SonarRangeFactor::geometryAt(double const* const* parameters,
                                                        bool at_linearization_points) const {
  const auto valueOf = [&](size_t block, const double* first) {
    return at_linearization_points && first ? first : parameters[block];
  };
  Geometry g;
  g.pose = poseFromBlock(valueOf(0, first_.pose ? first_.pose->data() : nullptr));
  for (size_t i = 0; i < hosts_; ++i) g.hosts.push_back(poseFromBlock(valueOf(1 + i, first_.hosts[i])));
  g.camera = is_camera_estimated_
                 ? correctedExtrinsics(body_from_camera_, valueOf(cameraBlock(), first_.camera))
                 : body_from_camera_;
  for (size_t i = 0; i < landmarks_.size(); ++i) {
    const SurfaceLandmark& landmark = landmarks_[i];
    const double* value = parameters[landmarkBlock(i)];
    const Rigid3& host = g.hosts[landmark.host];
    const double rho = value[2];
    const Vec3 point_B = g.camera.rotation * landmark.base.direction(value) + rho * g.camera.translation;
    const Vec3 from_body_W = host.rotation * point_B + rho * (host.translation - g.pose.translation);
    const Vec3 q =
        beam_.axes_B.transpose() * (g.pose.rotation.conjugate() * from_body_W - rho * beam_.origin_B);
    g.q.push_back(q);
    g.rho.push_back(rho);
    g.points.push_back({q[1] / q[0], q[2] / q[0], rho / q[0], landmark.weight});
  }
  return g;
}

bool SonarRangeFactor::Evaluate(double const* const* parameters, double* residuals,
                                double** jacobians) const {
  constexpr double kGross = 100.0;  // sigmas
  const BeamSurface surface(geometryAt(parameters, false).points);
  const bool is_gross = !(surface.inverseDistance_per_m() > 1.0 / kFarthest_m);
  residuals[0] = is_gross ? kGross : (1.0 / surface.inverseDistance_per_m() - range_m_) / sigma_m_;
  if (jacobians == nullptr) return true;
  for (size_t i = 0; i < parameter_block_sizes().size(); ++i) {
    if (jacobians[i]) std::fill_n(jacobians[i], parameter_block_sizes()[i], 0.0);
  }
  if (!is_gross) differentiate(geometryAt(parameters, true), parameters, jacobians);
  return true;
}

void SonarRangeFactor::differentiate(const Geometry& g, double const* const* parameters,
                                     double** jacobians) const {
  const BeamSurface surface(g.points);
  const double inverse = surface.inverseDistance_per_m();
  if (!(inverse > 1.0 / kFarthest_m)) return;
  const double by_inverse = -1.0 / (inverse * inverse * sigma_m_);
  const Mat3 beam_rotation_world = beam_.axes_B.transpose() * g.pose.rotation.conjugate().toRotationMatrix();
  for (size_t i = 0; i < landmarks_.size(); ++i) {
    const SurfaceLandmark& landmark = landmarks_[i];
    const double* value = parameters[landmarkBlock(i)];
    const BeamPoint& point = g.points[i];
    const Rigid3& host = g.hosts[landmark.host];
    const Vec3 by_point = by_inverse * surface.derivatives(i) / g.q[i][0];  // over q_0
    // a, b and y over q, times q_0.
    const Eigen::RowVector3d by_q(-by_point[0] * point.across_1 - by_point[1] * point.across_2 -
                                      by_point[2] * point.inverse_distance_per_m,
                                  by_point[0], by_point[1]);
    const Eigen::RowVector3d by_W = by_q * beam_rotation_world;
    const Vec3 direction_B = g.camera.rotation * landmark.base.direction(value);
    const Vec3 arm_W = host.rotation * (direction_B + g.rho[i] * g.camera.translation);
    const Vec3 from_body_W = arm_W + g.rho[i] * (host.translation - g.pose.translation);
    addTo(jacobians[0], joined(-g.rho[i] * by_W, by_W * so3::skew(from_body_W)));
    addTo(jacobians[1 + landmark.host], joined(g.rho[i] * by_W, -by_W * so3::skew(arm_W)));
    const Eigen::RowVector3d by_B = by_W * host.rotation.toRotationMatrix();
    if (is_camera_estimated_) {
      const Vec3 turn(first_.camera ? first_.camera : parameters[cameraBlock()]);
      addTo(jacobians[cameraBlock()],
            joined(-by_B * so3::skew(direction_B) * so3::leftJacobian(turn), g.rho[i] * by_B));
    }
    const Vec3 by_rho_W = host.rotation * g.camera.translation + host.translation - g.pose.translation;
    const Vec3 origin_in_beam = beam_.axes_B.transpose() * beam_.origin_B;
    const double by_rho = by_W.dot(by_rho_W) - by_q.dot(origin_in_beam) + by_point[2];
    Eigen::RowVector3d by_landmark;
    by_landmark << by_B * g.camera.rotation.toRotationMatrix() * landmark.base.tangent_C, by_rho;
    addTo(jacobians[landmarkBlock(i)], by_landmark);
  }
}

}  // namespace lodeline
