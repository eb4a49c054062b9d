#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/rig_calibration/record/board_record.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {

struct RigCalibrationOptions {
  std::string model;         ///< camera model for all cameras; empty: the stated one
  std::optional<Port> port;  ///< start for cameras whose file states no port
  bool keeps_lens = false;   ///< of the stated calibration
  bool keeps_port = false;   ///< of the stated calibration
  bool uses_imu = true;
  double most_delay_s = 0.15;          ///< between images and IMU, either way
  ShareDone progress = [](double) {};  ///< takes the share of the solutions that are done
};

/// What a calibration is worth. Poor results are not to be used.
enum class CalibrationVerdict { Good, Usable, Poor };
const char* toString(CalibrationVerdict verdict);

/// A reason against a calibration.
struct CalibrationDoubt {
  CalibrationVerdict verdict = CalibrationVerdict::Usable;
  std::string text;
};

/// Error of one corner.
struct CornerError {
  Vec2 pixel, error_px;  ///< where it was found; projection minus that
};

/// Standard deviations of a pose: turn about and shift along the axes of the frame to which it maps.
struct PoseSigmas {
  Vec3 rotation_rad = Vec3::Zero(), translation_m = Vec3::Zero();
};

/// Result for one camera.
struct CameraCalibrationResult {
  CameraCalibration calibration;
  std::vector<double> lens_sigmas;    ///< fx, fy, cx, cy (px) and the model's; empty for a kept lens
  std::optional<Vec3> port_sigmas;    ///< flat: tilts (rad), distance (m); dome: centre (m)
  std::optional<double> index_sigma;  ///< of the water; nothing where the stated index counts
  Rigid3 first_from_camera;           ///< to the first camera
  std::optional<PoseSigmas> first_sigmas;
  std::optional<PoseSigmas> body_sigmas;  ///< of CameraCalibration::body_from_camera
  std::optional<double> delay_sigma_s;
  double rms_px = 0.0;    ///< of both coordinates together, without the outliers
  double sigma_px = 0.0;  ///< of a corner per axis, that the sigmas assume
  double outlier_share = 0.0;
  double coverage_share = 0.0;    ///< of the image
  double largest_tilt_rad = 0.0;  ///< between the board and the image plane, 90 % of the views have less
  size_t images = 0, views = 0;
  std::vector<CornerError> corners;
};

/// Result of a calibration with an IMU.
struct InertialResult {
  double inertial_error = 1.0;  ///< of the readings in units of their noise densities
  double rate_error_rad_per_s = 0.0, least_rate_rad_per_s = 0.0;
  double least_acceleration_m_per_s2 = 0.0;  ///< standard deviation along the axis with the least
  Vec3 gyroscope_bias_B = Vec3::Zero(), accelerometer_bias_B = Vec3::Zero();
};

struct RigCalibrationResult {
  Rig rig;  ///< with the calibrated cameras
  CalibrationBoard board;
  std::vector<CameraCalibrationResult> cameras;
  std::optional<InertialResult> inertial;
  std::string without_inertial;  ///< reason; empty where `inertial` exists
  double sigma_inflation = 1.0;  ///< see Posterior::largest_inflation
  CalibrationVerdict verdict = CalibrationVerdict::Good;
  std::vector<CalibrationDoubt> doubts;
};

/// Calibrates the cameras of a recording, their ports and their place on the IMU. First the cameras alone,
/// then with the inertial readings. Throws EstimationError where the recording cannot determine a
/// calibration.
RigCalibrationResult calibrateRig(const BoardRecord& record, const RigCalibrationOptions& options,
                                  Diagnostics* diagnostics);

/// Judges a calibration by its sigmas, residuals and coverage; sets `verdict` and `doubts`.
void judge(RigCalibrationResult* result);

}  // namespace lodeline
