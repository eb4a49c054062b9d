#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/geometry/rigid3.h"

namespace lodeline {

/// Noise of an IMU as continuous densities in Kalibr's convention: two-sided square root of power per hertz.
/// A discrete sample at rate f has sigma = density * sqrt(f). The values are those of the datasheet or the
/// Allan analysis, without inflation.
struct ImuNoise {
  double gyroscope_density_rad_per_s_sqrtHz = 1.7e-4;
  double gyroscope_random_walk_rad_per_s2_sqrtHz = 2.0e-5;
  double accelerometer_density_m_per_s2_sqrtHz = 2.0e-3;
  double accelerometer_random_walk_m_per_s3_sqrtHz = 3.0e-3;
};

/// Prior standard deviation of the scale errors (relative) and misalignment (rad) of IMU axes, one sigma.
/// Manufacturers calibrate the axes of their better sensors; the gyroscope's white noise identifies these.
namespace imu_axes {
constexpr double kCalibratedBelow_rad_per_s_sqrtHz = 1.2e-4;
constexpr double kCalibratedSigma = 0.001;
constexpr double kUncalibratedSigma = 0.007;  ///< for a sensor that may never have been calibrated

inline double sigmaFor(const ImuNoise& noise) {
  return noise.gyroscope_density_rad_per_s_sqrtHz < kCalibratedBelow_rad_per_s_sqrtHz ? kCalibratedSigma
                                                                                      : kUncalibratedSigma;
}
}  // namespace imu_axes

/// The IMU defines the body frame B.
struct ImuCalibration {
  double rate_hz = 200.0;
  ImuNoise noise;
};

enum class DistortionModel {
  None,
  RadialTangential,  ///< Brown-Conrady: k1 k2 p1 p2 [k3 [k4 k5 k6]] (OpenCV's order)
  Equidistant,       ///< Kannala-Brandt: k1 k2 k3 k4
};

/// A camera as described by a calibration file; `makeCamera` creates the projection model from it.
struct CameraCalibration {
  std::string name;  ///< e.g. "cam0"
  int width_px = 0;
  int height_px = 0;
  double fx_px = 0.0;
  double fy_px = 0.0;
  double cx_px = 0.0;  ///< pixel centres have integer coordinates
  double cy_px = 0.0;
  DistortionModel distortion_model = DistortionModel::None;
  std::vector<double> distortion;
  double rate_hz = 20.0;
  Rigid3 body_from_camera;
  /// Offset added to camera stamps to obtain the IMU clock (Kalibr's timeshift_cam_imu).
  double time_offset_to_imu_s = 0.0;
  std::string mask_file;  ///< 8-bit image, zero where the rig itself covers the view; empty for none
};

struct MagnetometerCalibration {
  double rate_hz = 100.0;
  double noise_density_T_per_sqrtHz = 1.0e-8;
  Rigid3 body_from_magnetometer;
  /// Soft iron A and hard iron h (T) from `lodeline calibrate magnetometer` (paper section III-E): the field
  /// in M is A (reading - h). A is symmetric; body_from_magnetometer contains the remaining rotation.
  Mat3 iron_correction = Mat3::Identity();
  Vec3 hard_iron_T = Vec3::Zero();
  bool is_calibrated = false;  ///< whether iron_correction and hard_iron_T come from a calibration
  /// Offset added to magnetometer stamps to obtain the IMU clock; negative where the magnetometer lags the
  /// gyroscope.
  double time_offset_to_imu_s = 0.0;
  /// Optional results of the calibration: the magnitude of the corrected field, and one sigma of the hard
  /// iron per axis and of the rotation of body_from_magnetometer.
  std::optional<double> field_strength_T = std::nullopt;
  std::optional<double> hard_iron_sigma_T = std::nullopt;
  std::optional<double> rotation_sigma_rad = std::nullopt;

  /// A reading corrected for soft and hard iron, in body axes, T.
  Vec3 corrected_B(const Vec3& reading_M) const {
    return body_from_magnetometer.rotation * (iron_correction * (reading_M - hard_iron_T));
  }
};

struct PressureCalibration {
  double rate_hz = 1.0;
  double depth_noise_std_m = 0.02;
  Rigid3 body_from_pressure;
};

struct SonarCalibration {
  double rate_hz = 50.0;
  double range_noise_std_m = 0.05;
  /// The head turns about its z axis; the beam of the angle 0 points along x.
  Rigid3 body_from_sonar;
  double beam_width_rad = 0.035;  ///< full width, where the power has fallen to a half
  double max_range_m = 0.0;       ///< greater ranges are no echoes; 0: unlimited
};

/// All rigidly connected sensors with their extrinsics.
struct Rig {
  ImuCalibration imu;
  std::vector<CameraCalibration> cameras;
  std::optional<MagnetometerCalibration> magnetometer;
  std::optional<PressureCalibration> pressure;
  std::optional<SonarCalibration> sonar;
};

}  // namespace lodeline
