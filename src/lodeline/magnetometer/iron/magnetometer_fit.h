#pragma once

#include <optional>
#include <string>

#include "lodeline/geometry/types.h"

namespace lodeline {

/// How much of the sensor's model a calibration determined, richest first. What a model leaves out is taken
/// for ideal (or from an older calibration).
enum class IronModel {
  Full,      ///< A symmetric, h: 9 parameters
  Diagonal,  ///< A diagonal, h: 6
  Scale,     ///< A a multiple of the identity (or of the older A), h: 4
  Offset,    ///< h alone, for a field of known size: 3
  Kept,      ///< nothing: the older calibration stands
};
const char* toString(IronModel model);
/// Throws InputError, naming `where`, for another word.
IronModel ironModelFromString(const std::string& name, const std::string& where);

/// Where each part begins in the parameters of a calibration.
namespace fit_parameter {
constexpr int kIron = 0;      ///< A: xx yy zz xy xz yz
constexpr int kHardIron = 6;  ///< h, unit of the readings
constexpr int kRotation = 9;  ///< d in R_B_M = exp(d) R_B_M, rad, axes of B
constexpr int kSize = 12;
}  // namespace fit_parameter

/// A symmetric matrix from its entries xx yy zz xy xz yz, and back.
Mat3 symmetricMatrix(const Eigen::Matrix<double, 6, 1>& entries);
Eigen::Matrix<double, 6, 1> symmetricEntries(const Mat3& matrix);

/// A calibration with everything that is known about its worth. The field in magnetometer axes is
/// A (reading - h), as in MagnetometerCalibration.
struct MagnetometerFit {
  using Covariance = Eigen::Matrix<double, fit_parameter::kSize, fit_parameter::kSize>;

  IronModel model = IronModel::Full;
  Mat3 iron_correction = Mat3::Identity();  ///< A, symmetric; T per unit of the readings
  Vec3 hard_iron = Vec3::Zero();            ///< h, unit of the readings
  bool raw_readings = false;                ///< counts of no known unit; otherwise readings are in T
  /// R_B_M, where it was estimated (or known from the file of the recording, then without covariance).
  std::optional<Quat> body_from_magnetometer;
  std::optional<double> time_offset_to_imu_s;  ///< stamps + this = IMU clock, where it was estimated
  std::optional<double> time_offset_sigma_s;
  std::optional<double> noise_density_T_per_sqrtHz;

  double field_strength_T = 0.0;      ///< size that corrected readings have
  bool field_strength_known = false;  ///< from a model of the Earth's field; else the sensor's own scale
  std::optional<double> dip_rad;      ///< of the field below the horizon, measured
  Covariance covariance = Covariance::Zero();
  /// How far the IMU's axes, to which the estimated rotation leads, may be turned against the body, per axis;
  /// no motion tells. Not in the covariance: it is the same in every calibration of a rig.
  double axes_sigma_rad = 0.0;

  double residual_T = 0.0;        ///< RMS of |A (reading - h)| - F over the readings used
  double coverage_share = 0.0;    ///< of the sphere of directions
  double condition_number = 0.0;  ///< of the model's normal equations, columns scaled
  double rejected_share = 0.0;
  double heading_error_rad = 0.0;  ///< one sigma, from the covariance; see headingSigma()
  int readings = 0;                ///< that were used
  std::string verdict;

  /// The field in magnetometer axes, T.
  Vec3 corrected_M(const Vec3& reading) const { return iron_correction * (reading - hard_iron); }
  /// One sigma of the parameters, in their order.
  Eigen::Matrix<double, fit_parameter::kSize, 1> sigmas() const {
    return covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  }
};

}  // namespace lodeline
