#include "lodeline/factors/inertial_factor.h"

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

using namespace inertial_error;
using Vec15 = Eigen::Matrix<double, kSize, 1>;

// Offsets within a motion block.
constexpr int kVelocityAt = 0;
constexpr int kGyroscopeBiasAt = 3;
constexpr int kAccelerometerBiasAt = 6;

struct States {
  Rigid3 pose_k, pose_k1;
  Eigen::Matrix<double, kMotionSize, 1> motion_k, motion_k1;
  ImuAxes axes;

  /// Axes may be null.
  States(const double* pose_k_in, const double* motion_k_in, const double* pose_k1_in,
         const double* motion_k1_in, const double* gyroscope_axes_in, const double* accelerometer_axes_in)
      : pose_k(poseFromBlock(pose_k_in)),
        pose_k1(poseFromBlock(pose_k1_in)),
        motion_k(motion_k_in),
        motion_k1(motion_k1_in) {
    if (gyroscope_axes_in != nullptr) axes.gyroscope = SensorAxes(gyroscope_axes_in);
    if (accelerometer_axes_in != nullptr) axes.accelerometer = SensorAxes(accelerometer_axes_in);
  }

  Vec3 velocity_k() const { return motion_k.segment<3>(kVelocityAt); }
  Vec3 gyroscopeBias_k() const { return motion_k.segment<3>(kGyroscopeBiasAt); }
  Vec3 accelerometerBias_k() const { return motion_k.segment<3>(kAccelerometerBiasAt); }
  Vec3 velocity_k1() const { return motion_k1.segment<3>(kVelocityAt); }
};

// Residual before whitening, and the two world vectors that its Jacobian needs in axes of body k.
struct InertialError {
  Vec15 e;
  Vec3 displacement_W;     // beyond constant velocity and gravity, m
  Vec3 velocity_change_W;  // beyond gravity, m/s

  InertialError(const States& s, const Preintegration& preintegration, const Vec3& gravity_W) {
    const double dt = preintegration.dt_s();
    const Quat body_k_from_world = s.pose_k.rotation.conjugate();
    const RelativeMotion motion =
        preintegration.correctedFor(s.gyroscopeBias_k(), s.accelerometerBias_k(), s.axes);
    displacement_W =
        s.pose_k1.translation - s.pose_k.translation - dt * s.velocity_k() - 0.5 * dt * dt * gravity_W;
    velocity_change_W = s.velocity_k1() - s.velocity_k() - dt * gravity_W;
    e.segment<3>(kAlpha) = body_k_from_world * displacement_W - motion.alpha;
    e.segment<3>(kBeta) = body_k_from_world * velocity_change_W - motion.beta;
    e.segment<3>(kTheta) = so3::log(body_k_from_world * s.pose_k1.rotation * motion.gamma.conjugate());
    e.segment<6>(kGyroscopeBias) = s.motion_k1.tail<6>() - s.motion_k.tail<6>();
  }
};

// Derivatives of the residual before whitening. Those by a pose are by its 6 perturbation coordinates.
struct InertialJacobians {
  Eigen::Matrix<double, kSize, 6> pose_k = Eigen::Matrix<double, kSize, 6>::Zero();
  Eigen::Matrix<double, kSize, 9> motion_k = Eigen::Matrix<double, kSize, 9>::Zero();
  Eigen::Matrix<double, kSize, 6> pose_k1 = Eigen::Matrix<double, kSize, 6>::Zero();
  Eigen::Matrix<double, kSize, 9> motion_k1 = Eigen::Matrix<double, kSize, 9>::Zero();
  Eigen::Matrix<double, kSize, 9> gyroscope_axes = Eigen::Matrix<double, kSize, 9>::Zero();
  Eigen::Matrix<double, kSize, 9> accelerometer_axes = Eigen::Matrix<double, kSize, 9>::Zero();

  InertialJacobians(const States& s, const Preintegration& preintegration, const Vec3& gravity_W) {
    const double dt = preintegration.dt_s();
    const InertialError error(s, preintegration, gravity_W);
    const Vec3 theta = error.e.segment<3>(kTheta);
    const Mat3 body_k_from_world = s.pose_k.rotation.conjugate().toRotationMatrix();
    const Mat3 theta_by_rotation_k1 = so3::rightJacobianInverse(-theta) * body_k_from_world;

    pose_k.block<3, 3>(kAlpha, 0) = -body_k_from_world;
    pose_k.block<3, 3>(kAlpha, 3) = body_k_from_world * so3::skew(error.displacement_W);
    pose_k.block<3, 3>(kBeta, 3) = body_k_from_world * so3::skew(error.velocity_change_W);
    pose_k.block<3, 3>(kTheta, 3) = -theta_by_rotation_k1;
    pose_k1.block<3, 3>(kAlpha, 0) = body_k_from_world;
    pose_k1.block<3, 3>(kTheta, 3) = theta_by_rotation_k1;

    motion_k.block<3, 3>(kAlpha, kVelocityAt) = -dt * body_k_from_world;
    motion_k.block<3, 3>(kBeta, kVelocityAt) = -body_k_from_world;
    motion_k.block<6, 6>(kAlpha, kGyroscopeBiasAt) = -preintegration.biasJacobian().topRows<6>();
    const Mat3 theta_by_correction = thetaByCorrection(s, preintegration, theta);
    motion_k.block<3, 3>(kTheta, kGyroscopeBiasAt) =
        theta_by_correction * preintegration.biasJacobian().block<3, 3>(kTheta, 0);
    gyroscope_axes.topRows<6>() = -preintegration.gyroscopeAxesJacobian().topRows<6>();
    gyroscope_axes.middleRows<3>(kTheta) =
        theta_by_correction * preintegration.gyroscopeAxesJacobian().middleRows<3>(kTheta);
    accelerometer_axes.topRows<6>() = -preintegration.accelerometerAxesJacobian().topRows<6>();
    motion_k.block<6, 6>(kGyroscopeBias, kGyroscopeBiasAt).diagonal().setConstant(-1.0);
    motion_k1.block<3, 3>(kBeta, kVelocityAt) = body_k_from_world;
    motion_k1.block<6, 6>(kGyroscopeBias, kGyroscopeBiasAt).setIdentity();
  }

 private:
  // gamma is corrected by exp(c). A further change d of c rotates gamma by J_l(c) d in body k, on the right
  // side of the residual's rotation.
  static Mat3 thetaByCorrection(const States& s, const Preintegration& preintegration, const Vec3& theta) {
    const Vec3 correction = preintegration.biasJacobian().block<3, 3>(kTheta, 0) *
                                (s.gyroscopeBias_k() - preintegration.gyroscopeBias()) +
                            preintegration.gyroscopeAxesJacobian().middleRows<3>(kTheta) * s.axes.gyroscope;
    return -so3::rightJacobianInverse(theta) * so3::leftJacobian(correction);
  }
};

using PoseJacobian = Eigen::Matrix<double, kSize, kPoseSize, Eigen::RowMajor>;
using NineColumns = Eigen::Matrix<double, kSize, 9, Eigen::RowMajor>;  // of a motion, of the axes

void writePose(const Preintegration::Mat15& whitening, const Eigen::Matrix<double, kSize, 6>& jacobian,
               double* out) {
  if (out == nullptr) return;
  Eigen::Map<PoseJacobian> block(out);
  block.leftCols<kPoseTangentSize>().noalias() = whitening * jacobian;
  block.rightCols<1>().setZero();
}

void writeNine(const Preintegration::Mat15& whitening, const Eigen::Matrix<double, kSize, 9>& jacobian,
               double* out) {
  if (out == nullptr) return;
  Eigen::Map<NineColumns>(out).noalias() = whitening * jacobian;
}

}  // namespace

InertialFactor::InertialFactor(const Preintegration* preintegration, const Vec3& gravity_W,
                               const InertialLinearizationPoints& linearization_points, EstimatedAxes axes)
    : preintegration_(preintegration),
      gravity_W_(gravity_W),
      linearization_points_(linearization_points),
      axes_(axes) {
  set_num_residuals(kSize);
  *mutable_parameter_block_sizes() = {kPoseSize, kMotionSize, kPoseSize, kMotionSize};
  if (axes.gyroscope) mutable_parameter_block_sizes()->push_back(kSensorAxesSize);
  if (axes.accelerometer) mutable_parameter_block_sizes()->push_back(kSensorAxesSize);
}

bool InertialFactor::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const int accelerometer_at = axes_.gyroscope ? 5 : 4;
  const double* gyroscope_axes = axes_.gyroscope ? parameters[4] : nullptr;
  const double* accelerometer_axes = axes_.accelerometer ? parameters[accelerometer_at] : nullptr;
  const States current(parameters[0], parameters[1], parameters[2], parameters[3], gyroscope_axes,
                       accelerometer_axes);
  const Preintegration::Mat15& whitening = preintegration_->whitening();
  Eigen::Map<Vec15>(residuals).noalias() = whitening * InertialError(current, *preintegration_, gravity_W_).e;
  if (jacobians == nullptr) return true;

  const auto firstOr = [](const double* first, const double* now) { return first != nullptr ? first : now; };
  const States linearized(firstOr(linearization_points_.pose_k, parameters[0]),
                          firstOr(linearization_points_.motion_k, parameters[1]),
                          firstOr(linearization_points_.pose_k1, parameters[2]),
                          firstOr(linearization_points_.motion_k1, parameters[3]),
                          firstOr(linearization_points_.gyroscope_axes, gyroscope_axes),
                          firstOr(linearization_points_.accelerometer_axes, accelerometer_axes));
  const InertialJacobians by(linearized, *preintegration_, gravity_W_);
  writePose(whitening, by.pose_k, jacobians[0]);
  writeNine(whitening, by.motion_k, jacobians[1]);
  writePose(whitening, by.pose_k1, jacobians[2]);
  writeNine(whitening, by.motion_k1, jacobians[3]);
  if (axes_.gyroscope) writeNine(whitening, by.gyroscope_axes, jacobians[4]);
  if (axes_.accelerometer) writeNine(whitening, by.accelerometer_axes, jacobians[accelerometer_at]);
  return true;
}

}  // namespace lodeline
