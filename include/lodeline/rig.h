#pragma once

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/types.h"

namespace lodeline {

/// One reading of the gyroscope and accelerometer in the body frame B (= IMU frame).
struct ImuSample {
  Time time;
  Vec3 angular_velocity_B = Vec3::Zero();  ///< rad/s, biased
  Vec3 specific_force_B = Vec3::Zero();    ///< m/s^2, biased; +9.8 along up at rest
  /// Time between the real readings on both sides of the step that ends here, s; 0 where it equals the step.
  /// An interpolated sample within a gap keeps the length of the whole gap, in which the motion is unknown.
  double gap_s = 0.0;
};

/// One raw magnetometer reading in the magnetometer frame M.
struct MagnetometerSample {
  Time time;
  Vec3 field_M = Vec3::Zero();  ///< T
};

/// One depth reading from a pressure sensor.
struct DepthSample {
  Time time;
  double depth_m = 0.0;  ///< positive down
};

/// One echo of a pencil-beam scanning sonar.
struct SonarSample {
  Time time;
  double range_m = 0.0;
  double angle_rad = 0.0;  ///< angle of the beam about the axis of the sonar head
};

/// One echo of an altimeter: a sonar with one fixed beam.
struct AltimeterSample {
  Time time;
  double range_m = 0.0;
};

/// What a Doppler velocity log (DVL) measured its velocity against.
enum class DvlTrack { Bottom, Water };

/// One beam of a ping of a DVL.
struct DvlBeam {
  int index = 0;  ///< in DvlCalibration::beams_D
  /// Velocity of the instrument along the beam, positive from the instrument outwards; nothing without lock.
  std::optional<double> velocity_m_per_s = std::nullopt;
  std::optional<double> range_m = std::nullopt;  ///< along the beam
};

/// One ping of a DVL, in its frame D: a velocity of the instrument, or its beams, or both. Where it has
/// beams, the velocity is their combination and not a measurement beside them.
struct DvlSample {
  Time time;
  DvlTrack track = DvlTrack::Bottom;
  std::optional<Vec3> velocity_D = std::nullopt;                ///< m/s; nothing where it is not valid
  std::optional<double> velocity_sigma_m_per_s = std::nullopt;  ///< of each axis, as the instrument states it
  std::vector<DvlBeam> beams;
};

/// Electric currents at one time, A, in the order of CurrentCalibration::channels.
struct CurrentSample {
  Time time;
  std::vector<double> currents_A;
};

/// Noise of an IMU as continuous densities in Kalibr's convention: two-sided square root of power per hertz.
/// A discrete sample at rate f has sigma = density * sqrt(f). The values are those of the datasheet or the
/// Allan analysis, without inflation.
struct ImuNoise {
  double gyroscope_density_rad_per_s_sqrtHz = 1.7e-4;
  double gyroscope_random_walk_rad_per_s2_sqrtHz = 2.0e-5;
  double accelerometer_density_m_per_s2_sqrtHz = 2.0e-3;
  double accelerometer_random_walk_m_per_s3_sqrtHz = 3.0e-3;
  /// One sigma of the scale errors (relative) and the misalignment (rad) of the axes. Empty where the
  /// calibration does not state it.
  std::optional<double> axes_sigma = std::nullopt;
};

/// Standard deviation of the scale errors (relative) and misalignment (rad) of IMU axes, as stated or by
/// default. Manufacturers calibrate the axes of their better sensors; by default, the gyroscope's white noise
/// identifies these.
namespace imu_axes {
constexpr double kCalibratedBelow_rad_per_s_sqrtHz = 1.2e-4;
constexpr double kCalibratedSigma = 0.001;
constexpr double kUncalibratedSigma = 0.007;  ///< for a sensor that may never have been calibrated

inline double sigmaFor(const ImuNoise& noise) {
  const bool is_quiet = noise.gyroscope_density_rad_per_s_sqrtHz < kCalibratedBelow_rad_per_s_sqrtHz;
  return noise.axes_sigma.value_or(is_quiet ? kCalibratedSigma : kUncalibratedSigma);
}
/// Whether the maker calibrated the axes.
inline bool areCalibrated(const ImuNoise& noise) { return sigmaFor(noise) < 0.002; }
}  // namespace imu_axes

/// The IMU defines the body frame B.
struct ImuCalibration {
  double rate_hz = 200.0;
  ImuNoise noise;
};

/// The window of a camera's housing towards the water: a flat plate, or a dome of two concentric spheres. C
/// is the frame of the lens, with its centre of projection as origin.
struct Port {
  enum class Type { Flat, Dome };
  Type type = Type::Flat;
  Vec3 normal_C = Vec3::UnitZ();  ///< flat: unit normal of the plate, towards the water
  double distance_m = 0.0;        ///< flat: from the lens to the inner face, along the normal
  Vec3 centre_C = Vec3::Zero();   ///< dome: centre of the spheres, m
  double radius_m = 0.0;          ///< dome: radius of the inner face
  double thickness_m = 0.0;
  double index_air = 1.0;  ///< refractive indices of the housing's content, the plate and the water
  double index_glass = 1.49;
  double index_water = 1.333;
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
  std::string model = "none";      ///< name of a CameraModel (cameras/camera_model.h)
  std::vector<double> distortion;  ///< parameters of the model after fx, fy, cx, cy
  double rate_hz = 20.0;
  Rigid3 body_from_camera;
  /// Offset added to camera stamps to obtain the IMU clock (Kalibr's timeshift_cam_imu).
  double time_offset_to_imu_s = 0.0;
  /// Rolling shutter: time from one row to the next, and its standard deviation. Both are 0 for a global
  /// shutter, and the line delay is then no state.
  double line_delay_s = 0.0;
  double line_delay_sigma_s = 0.0;
  std::string mask_file;  ///< 8-bit image, zero where the rig itself covers the view; empty for none
  /// Behind a port, the model and its parameters are those of the lens in air.
  std::optional<Port> port = std::nullopt;

  bool hasRollingShutter() const { return line_delay_s != 0.0 || line_delay_sigma_s != 0.0; }
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

/// A Doppler velocity log. Its frame D has z along the axis of the beams, from the instrument outwards.
struct DvlCalibration {
  double rate_hz = 5.0;
  double velocity_noise_std_m_per_s = 0.01;  ///< of each axis, and of each beam along its direction
  double range_noise_std_m = 0.05;           ///< of each beam
  Rigid3 body_from_dvl;
  double time_offset_to_imu_s = 0.0;  ///< added to stamps to obtain the IMU clock
  /// Unit vectors of the beams, from the instrument outwards; by default four at 22.5 degrees to z.
  std::vector<Vec3> beams_D = janusBeams_D(22.5 * 3.14159265358979323846 / 180.0);
  double scale_sigma = 0.01;             ///< one sigma of the speed of sound, relative
  double misalignment_sigma_rad = 0.03;  ///< one sigma of the rotation of body_from_dvl, each axis

  /// Four beams at an angle to z, at azimuths of 45, 135, 225 and 315 degrees from x towards y.
  static std::vector<Vec3> janusBeams_D(double angle_to_z_rad) {
    const double side = std::sin(angle_to_z_rad) / std::sqrt(2.0);
    const double along = std::cos(angle_to_z_rad);
    return {{side, side, along}, {-side, side, along}, {-side, -side, along}, {side, -side, along}};
  }
};

/// Measured electric currents that disturb the magnetometer: thrusters, lamps, battery. The field of a
/// current is proportional to it, so the corrected field is A (reading - h - sum_i k_i I_i).
struct CurrentCalibration {
  double rate_hz = 10.0;
  std::vector<std::string> channels;  ///< names
  /// k_i, T/A in axes of the magnetometer's readings, one for each channel; empty without calibration.
  std::vector<Vec3> fields_T_per_A;
  double field_sigma_T_per_A = 0.0;   ///< one sigma of each component of k_i
  double time_offset_to_imu_s = 0.0;  ///< added to stamps to obtain the IMU clock
};

/// All rigidly connected sensors with their extrinsics.
struct Rig {
  ImuCalibration imu;
  std::vector<CameraCalibration> cameras;
  std::optional<MagnetometerCalibration> magnetometer;
  std::optional<PressureCalibration> pressure;
  std::optional<SonarCalibration> sonar;
  std::optional<SonarCalibration> altimeter;  ///< its beam points along x
  std::optional<DvlCalibration> dvl;
  std::optional<CurrentCalibration> currents;
};

/// Calibrated scale, misalignment and bias of an IMU, and the correction of its readings. The measurement
/// model is Kalibr's with constant biases:
///
///     gyroscope reading     = G^-1 w + S f + b_g        accelerometer reading = F^-1 f + b_a
///
/// with the angular velocity w (rad/s) and the specific force f (m/s^2) in body axes.
struct ImuCorrection {
  Mat3 accelerometer = Mat3::Identity();  ///< F
  Mat3 gyroscope = Mat3::Identity();      ///< G, includes the rotation from the gyroscope's axes to B
  Mat3 g_sensitivity = Mat3::Zero();      ///< S, rad/s per m/s^2
  Vec3 accelerometer_bias = Vec3::Zero();
  Vec3 gyroscope_bias = Vec3::Zero();
  /// Offset added to IMU stamps to obtain the clock of the cameras' offsets (Kalibr's time_offset).
  double time_offset_s = 0.0;

  ImuSample applied(const ImuSample& reading) const {
    ImuSample sample;
    sample.time = reading.time + Duration::fromSeconds(time_offset_s);
    sample.specific_force_B = accelerometer * (reading.specific_force_B - accelerometer_bias);
    sample.angular_velocity_B =
        gyroscope * (reading.angular_velocity_B - gyroscope_bias - g_sensitivity * sample.specific_force_B);
    return sample;
  }

  /// Largest relative change of a single-axis reading caused by scale and misalignment.
  double largestChange() const {
    const double force = (accelerometer - Mat3::Identity()).cwiseAbs().maxCoeff();
    return std::max(force, (gyroscope - Mat3::Identity()).cwiseAbs().maxCoeff());
  }
  bool isIdentity() const {
    return largestChange() == 0.0 && g_sensitivity.isZero(0.0) && accelerometer_bias.isZero(0.0) &&
           gyroscope_bias.isZero(0.0) && time_offset_s == 0.0;
  }
};

/// A rig and the correction of its recorded inertial readings, where its files state one.
struct DescribedRig {
  Rig rig;  ///< unstated rates are 0; LiveSource::settleRates() measures them
  std::optional<ImuCorrection> imu_correction;
};

/// Reads files that together describe a rig: this program's rig files, EuRoC's, Kalibr's, OpenVINS' and
/// others (docs/reference/file-formats.md). Throws InputError where a file is wrong, and for a rig without
/// camera or IMU.
DescribedRig readRig(const std::vector<std::filesystem::path>& files, Diagnostics* diagnostics);

}  // namespace lodeline
