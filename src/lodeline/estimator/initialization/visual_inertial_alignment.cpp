#include "lodeline/estimator/initialization/visual_inertial_alignment.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

// Weights of the linear system: approximate accuracy of visual positions (m) and of preintegrated velocities
// (m/s, rotated by visual attitudes) over a tenth of a second.
constexpr double kPositionSigma = 0.005;
constexpr double kVelocitySigma = 0.01;

/// Least squares for [velocities, gravity coordinates, accelerometer bias, scale], gravity = offset + basis *
/// coordinates.
Eigen::VectorXd solveLinear(const std::vector<Quat>& visual_from_body,
                            const std::vector<Vec3>& camera_positions_V, const Vec3& camera_position_B,
                            const std::vector<Preintegration*>& intervals, const Vec3& gravity_offset,
                            const Eigen::MatrixXd& gravity_basis, double bias_sigma,
                            const MeasuredVelocities& measured) {
  const int frames = static_cast<int>(visual_from_body.size());
  const int gravity = 3 * frames;
  const int gravity_size = static_cast<int>(gravity_basis.cols());
  const int bias = gravity + gravity_size;
  const int scale = bias + 3;
  const int prior_row = 6 * (frames - 1), measured_row = prior_row + 3;
  const int rows = measured_row + 3 * static_cast<int>(measured.size());
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(rows, scale + 1);
  Eigen::VectorXd b = Eigen::VectorXd::Zero(rows);
  a.block<3, 3>(prior_row, bias) = Mat3::Identity() / bias_sigma;
  for (int k = 0; k < static_cast<int>(measured.size()); ++k) {
    if (!measured[k]) continue;
    const double weight = 1.0 / measured[k]->sigma_m_per_s, elapsed_s = measured[k]->elapsed_s;
    auto velocity = a.middleRows<3>(measured_row + 3 * k);
    velocity.middleCols<3>(3 * k) = weight * Mat3::Identity();
    velocity.middleCols(gravity, gravity_size) = -weight * elapsed_s * gravity_basis;
    b.segment<3>(measured_row + 3 * k) =
        weight * (visual_from_body[k] * measured[k]->velocity_B + elapsed_s * gravity_offset);
  }
  for (int k = 0; k + 1 < frames; ++k) {
    const double dt = intervals[k]->dt_s();
    const RelativeMotion& motion = intervals[k]->motion();
    const Mat3 rotation = visual_from_body[k].toRotationMatrix();
    const Mat3 alpha_by_bias = intervals[k]->biasJacobian().block<3, 3>(inertial_error::kAlpha, 3);
    const Mat3 beta_by_bias = intervals[k]->biasJacobian().block<3, 3>(inertial_error::kBeta, 3);
    const Vec3& bias_then = intervals[k]->accelerometerBias();
    const Vec3 arm_change_V =
        visual_from_body[k + 1] * camera_position_B - visual_from_body[k] * camera_position_B;
    auto position = a.middleRows<3>(6 * k);
    position.middleCols<3>(3 * k) = -dt * Mat3::Identity();
    position.middleCols(gravity, gravity_size) = -0.5 * dt * dt * gravity_basis;
    position.middleCols<3>(bias) = -rotation * alpha_by_bias;
    position.col(scale) = camera_positions_V[k + 1] - camera_positions_V[k];
    b.segment<3>(6 * k) =
        rotation * (motion.alpha - alpha_by_bias * bias_then) + arm_change_V + 0.5 * dt * dt * gravity_offset;
    position /= kPositionSigma;
    b.segment<3>(6 * k) /= kPositionSigma;
    auto velocity = a.middleRows<3>(6 * k + 3);
    velocity.middleCols<3>(3 * k) = -Mat3::Identity();
    velocity.middleCols<3>(3 * k + 3) = Mat3::Identity();
    velocity.middleCols(gravity, gravity_size) = -dt * gravity_basis;
    b.segment<3>(6 * k + 3) = rotation * (motion.beta - beta_by_bias * bias_then) + dt * gravity_offset;
    velocity.middleCols<3>(bias) = -rotation * beta_by_bias;
    velocity /= kVelocitySigma;
    b.segment<3>(6 * k + 3) /= kVelocitySigma;
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(a);
  if (qr.rank() < a.cols()) return {};
  return qr.solve(b);
}

}  // namespace

Vec3 alignGyroscopeBias(const std::vector<Quat>& rotations, const std::vector<Preintegration*>& intervals) {
  Vec3 bias = intervals.front()->gyroscopeBias();
  for (int pass = 0; pass < 2; ++pass) {
    Mat3 information = Mat3::Zero();
    Vec3 right_side = Vec3::Zero();
    for (size_t k = 0; k < intervals.size(); ++k) {
      const Quat visual = rotations[k].conjugate() * rotations[k + 1];
      const Vec3 error = so3::log(visual * intervals[k]->motion().gamma.conjugate());
      const Mat3 jacobian = intervals[k]->biasJacobian().block<3, 3>(inertial_error::kTheta, 0);
      information += jacobian.transpose() * jacobian;
      right_side += jacobian.transpose() * error;
    }
    bias += information.ldlt().solve(right_side);
    for (Preintegration* interval : intervals) interval->repropagate(bias, interval->accelerometerBias());
  }
  return bias;
}

std::optional<VisualInertialAlignment> alignVisualInertial(
    const std::vector<Quat>& visual_from_body, const std::vector<Vec3>& camera_positions_V,
    const Vec3& camera_position_B, const std::vector<Preintegration*>& intervals, double gravity_magnitude,
    double bias_sigma_m_per_s2, const MeasuredVelocities& measured) {
  const auto solve = [&](const Vec3& offset, const Eigen::MatrixXd& basis) {
    return solveLinear(visual_from_body, camera_positions_V, camera_position_B, intervals, offset, basis,
                       bias_sigma_m_per_s2, measured);
  };
  const int gravity = 3 * static_cast<int>(visual_from_body.size());
  Eigen::VectorXd x = solve(Vec3::Zero(), Mat3::Identity());
  if (x.size() == 0 || !x.allFinite()) return std::nullopt;
  VisualInertialAlignment alignment;
  Vec3 direction = x.segment<3>(gravity);
  alignment.free_gravity_magnitude = direction.norm();
  if (alignment.free_gravity_magnitude < 1e-3) return std::nullopt;
  direction.normalize();
  for (int pass = 0; pass < 4; ++pass) {
    const Mat32 basis = tangentBasis(direction);
    x = solve(gravity_magnitude * direction, basis);
    if (x.size() == 0 || !x.allFinite()) return std::nullopt;
    direction = (gravity_magnitude * direction + basis * x.segment<2>(gravity)).normalized();
  }
  alignment.scale = x[x.size() - 1];
  if (alignment.scale <= 0.0) return std::nullopt;
  alignment.gravity_V = gravity_magnitude * direction;
  alignment.accelerometer_bias_B = x.segment<3>(gravity + 2);
  for (size_t k = 0; k < visual_from_body.size(); ++k)
    alignment.velocities_V.push_back(x.segment<3>(3 * static_cast<int>(k)));
  return alignment;
}

}  // namespace lodeline
