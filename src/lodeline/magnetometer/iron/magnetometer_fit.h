#pragma once

#include <optional>
#include <string>

#include "lodeline/types.h"

namespace lodeline {

/// Set of parameters that a calibration determined, richest first. The other parameters are ideal or come
/// from an older calibration.
enum class IronModel {
  Full,      ///< A symmetric, h: 9 parameters
  Diagonal,  ///< A diagonal, h: 6
  Scale,     ///< A a multiple of the identity (or of the older A), h: 4
  Offset,    ///< h alone, for a field of known size: 3
  Kept,      ///< nothing: the older calibration is kept
};
const char* toString(IronModel model);
/// Parses the name of a model. Throws InputError, naming `where`, for any other word.
IronModel ironModelFromString(const std::string& name, const std::string& where);

/// First index of each part in the parameters of a calibration.
namespace fit_parameter {
constexpr int kIron = 0;      ///< A: xx yy zz xy xz yz
constexpr int kHardIron = 6;  ///< h, unit of the readings
constexpr int kRotation = 9;  ///< d in R_B_M = exp(d) R_B_M, rad, axes of B
constexpr int kSize = 12;
}  // namespace fit_parameter

/// Conversion between a symmetric matrix and its entries xx yy zz xy xz yz.
Mat3 symmetricMatrix(const Eigen::Matrix<double, 6, 1>& entries);
Eigen::Matrix<double, 6, 1> symmetricEntries(const Mat3& matrix);

/// A calibration with its uncertainty and quality figures. The field in the magnetometer frame M is A
/// (reading - h), as in MagnetometerCalibration.
struct MagnetometerFit {
  using Covariance = Eigen::Matrix<double, fit_parameter::kSize, fit_parameter::kSize>;

  IronModel model = IronModel::Full;
  Mat3 iron_correction = Mat3::Identity();  ///< A, symmetric; T per unit of the readings
  Vec3 hard_iron = Vec3::Zero();            ///< h, unit of the readings
  bool raw_readings = false;                ///< readings are counts of unknown unit; otherwise they are in T
  /// R_B_M where estimated, or from the recording's file, then without covariance.
  std::optional<Quat> body_from_magnetometer;
  std::optional<double> time_offset_to_imu_s;  ///< stamps + offset = IMU clock, where estimated
  std::optional<double> time_offset_sigma_s;
  std::optional<double> noise_density_T_per_sqrtHz;

  double field_strength_T = 0.0;      ///< magnitude of corrected readings
  bool field_strength_known = false;  ///< from a model of the Earth's field; otherwise the sensor's own scale
  std::optional<double> dip_rad;      ///< measured angle of the field below the horizon
  Covariance covariance = Covariance::Zero();
  /// Possible rotation of the IMU's axes, to which the estimated rotation refers, relative to the body, one
  /// sigma per axis. No motion can determine it. The covariance does not contain it because it is equal in
  /// every calibration of a rig.
  double axes_sigma_rad = 0.0;

  double residual_T = 0.0;        ///< RMS of |A (reading - h)| - F over the readings used
  double coverage_share = 0.0;    ///< fraction of the sphere of directions
  double condition_number = 0.0;  ///< of the model's normal equations with scaled columns
  double rejected_share = 0.0;
  double heading_error_rad = 0.0;  ///< one sigma, from the covariance; see headingSigma()
  int readings = 0;                ///< number of readings used
  std::string verdict;

  /// Corrected field in the magnetometer frame M, T.
  Vec3 corrected_M(const Vec3& reading) const { return iron_correction * (reading - hard_iron); }
  /// Standard deviations of the parameters in their order.
  Eigen::Matrix<double, fit_parameter::kSize, 1> sigmas() const {
    return covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  }
};

}  // namespace lodeline
