#pragma once

#include "lodeline/types.h"

namespace lodeline {

/// Parameters of the inertial calibration without the orientations. Magnetic quantities are in units of the
/// field magnitude F. The world frame has x to magnetic east, y to magnetic north, z up.
struct InertialParameters {
  Mat3 soft_iron = Mat3::Identity();  ///< S = A^-1, symmetric
  Vec3 hard_iron = Vec3::Zero();      ///< h
  Quat body_from_magnetometer = Quat::Identity();
  double dip_rad = 0.0;
  Vec3 gyroscope_bias_B = Vec3::Zero();      ///< rad/s
  double time_offset_s = 0.0;                ///< magnetometer stamps + offset = IMU clock
  Vec3 accelerometer_bias_B = Vec3::Zero();  ///< m/s^2

  Vec3 field_W() const;
};

/// First index of each part in a step of the parameters.
namespace inertial_parameter {
constexpr int kSoftIron = 0;  ///< xx yy zz xy xz yz
constexpr int kHardIron = 6;
constexpr int kRotation = 9;  ///< d in R_B_M <- exp(d) R_B_M, rad
constexpr int kDip = 12;
constexpr int kGyroscopeBias = 13;
constexpr int kTimeOffset = 16;
constexpr int kAccelerometerBias = 17;
constexpr int kSize = 20;
}  // namespace inertial_parameter

InertialParameters moved(const InertialParameters& from,
                         const Eigen::Matrix<double, inertial_parameter::kSize, 1>& step);

/// A residual, not whitened, with its derivatives by the orientation (right perturbation, R_W_B <- R_W_B
/// exp(phi)) and by the parameters.
struct InertialResidual {
  Vec3 value = Vec3::Zero();
  Mat3 by_rotation = Mat3::Zero();
  Eigen::Matrix<double, 3, inertial_parameter::kSize> by_parameters =
      Eigen::Matrix<double, 3, inertial_parameter::kSize>::Zero();
};

/// Magnetometer residual for the mean y of the readings around a moment (Kok & Schön, IEEE Sensors Journal
/// 2016, equation 10, in the factors used here):
///   e = y - S R_M_B C R_B_W m_W - h,
/// C is the mean of the rotations from the body at that moment to the body at each reading. `rate_B` is
/// the angular velocity, for the derivative by the time offset.
InertialResidual fieldResidual(const Vec3& reading, const Mat3& mean_turn, const Vec3& rate_B,
                               const Quat& world_from_body, const InertialParameters& parameters);

/// Accelerometer residual for a body whose mean acceleration is small:  e = f - b_a - R_B_W (-g_W), m/s^2.
InertialResidual gravityResidual(const Vec3& specific_force_B, const Quat& world_from_body,
                                 const InertialParameters& parameters);

/// Gyroscope residual between two moments, rad:  e = log(dR^T R_B_W^k R_W_B^{k+1}). dR is the rotation
/// integrated with the parameters' bias, and dR(b + d) = dR exp(J d).
struct TurnResidual {
  Vec3 value = Vec3::Zero();
  Mat3 by_first = Mat3::Zero();
  Mat3 by_second = Mat3::Zero();
  Mat3 by_bias = Mat3::Zero();
};
TurnResidual turnResidual(const Quat& first_from_second, const Mat3& by_bias, const Quat& world_from_first,
                          const Quat& world_from_second);

}  // namespace lodeline
