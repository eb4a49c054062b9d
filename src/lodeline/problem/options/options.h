#pragma once

#include <algorithm>

#include "lodeline/imu/gravity.h"
#include "lodeline/imu/gravity_alignment.h"
#include "lodeline/imu/preintegration.h"
#include "lodeline/problem/options/depth_options.h"
#include "lodeline/problem/options/dvl_options.h"
#include "lodeline/problem/options/magnetometer_options.h"
#include "lodeline/problem/options/sonar_options.h"
#include "lodeline/types.h"

namespace lodeline {

/// Standard deviations of the state of the first frame.
struct InitialStateOptions {
  double alignment_window_s = 1.0;  ///< of readings before the first frame, from which the tilt is computed
  int min_stereo_tracks = 20;
  double position_sigma_m = 1e-4;  ///< with the heading it defines the world's frame, hence tiny
  double yaw_sigma_rad = 1e-4;
  double tilt_sigma_min_rad = 0.01;
  double velocity_sigma_m_per_s = 1.0;
  double gyroscope_bias_sigma_rad_per_s = 0.1;
  double accelerometer_bias_sigma_m_per_s2 = 0.2;

  /// Throws UsageError where a value is out of its range.
  void check() const;
};

struct MonoInitializationOptions {
  double min_frame_distance_s = 0.08;  ///< images in between are skipped
  double max_duration_s = 5.0;         ///< a slow swimmer needs some distance before far points move by 10 px
  int min_frames = 6;
  int min_common_tracks = 20;  ///< observed by the oldest and the newest frame
  double min_parallax_px = 5.0;
  double max_epipolar_error_px = 1.0;
  /// Accepted error of the magnitude of gravity when the alignment estimates it freely.
  double gravity_tolerance_m_per_s2 = 1.0;
  double start_tilt_sigma_rad = 0.3;
  int max_iterations = 100;
  double max_bias_sigmas = 4.0;  ///< a larger accelerometer bias counts as a false minimum
  /// Mean square of the whitened inertial residuals; a larger one counts as a false minimum.
  double max_inertial_disagreement = 1.5;
  double max_scale_sigma = 0.1;  ///< relative; the initialization waits while the scale sigma is larger
  double retry_after_s = 0.2;    ///< a failed initialization has cost a second of computing

  /// Throws UsageError where a value is out of its range.
  void check() const;
};

struct WindowOptions {
  int recent_frames = 5;  ///< newest frames, kept with velocity and biases
  int keyframes = 12;     ///< older keyframes, kept as poses
  /// Position of a split among the older keyframes. When a landmark outlives the oldest keyframe, its
  /// observations before the newest `split_at_keyframe` of the older keyframes go into the prior. The rest of
  /// its observations continue with a new landmark.
  int split_at_keyframe = 2;
  /// Observations of other frames between two keyframes are kept if the keyframes are no further apart than
  /// `interpolated_gap_s`. `interpolated_spacing_s` is the spacing of the kept observations.
  double interpolated_gap_s = 1.6;
  double interpolated_spacing_s = 0.18;
  /// Landmarks that no recent frame observes are linearized anew after this many frames; 0: in every frame.
  int frozen_frames = 8;
  /// No marginalization before this number of frames, so that no early, inaccurate linearization is kept.
  /// With one camera the scale converges slowly. The estimator then waits for `startup_frames_mono` frames,
  /// and until the scale is known to `startup_scale_sigma` (relative). After `startup_max_frames` frames are
  /// marginalized in any case, but no linearization is kept until the scale is known.
  int startup_frames = 20;
  int startup_frames_mono = 45;
  int startup_max_frames = 60;
  double startup_scale_sigma = 0.03;

  /// Throws UsageError where a value is out of its range.
  void check() const;
};

struct KeyframeOptions {
  double min_tracked_share = 0.7;  ///< of the last keyframe's landmarks still observed
  double min_parallax_rad = 0.02;  ///< median shift of the common tracks without rotation
  /// Minimum interval between keyframes that parallax requests. The window of a fast rig must span some time,
  /// or landmarks outlive it.
  double min_interval_s = 0.24;
  int min_landmarks = 30;  ///< fewer observed landmarks request a keyframe
  /// A frame with few observations becomes a keyframe only when this share of its tracks is new since the
  /// last one.
  double min_fresh_share = 0.2;

  /// Throws UsageError where a value is out of its range.
  void check() const;
};

struct LandmarkOptions {
  int max_landmarks = 200;
  /// While fewer landmarks than this are in view, new points become landmarks however many the window holds.
  /// After darkness the window may be full of landmarks from before.
  int least_in_view = 50;
  /// Minimum number of frames that observe a point before it becomes a landmark, as soon as the window has
  /// that many. Where nothing is visible (silt, darkness full of the blocks of a compressed video, particles
  /// in the lamp's light), feature tracks are random. Any such point can be triangulated from two views, and
  /// hundreds of them bias the motion towards zero.
  int min_frames = 3;
  double min_distance_m = 0.05;
  /// Largest sigma of the inverse distance at which a point becomes a landmark. It is relative to the usual
  /// inverse distance of the landmarks in view (in a window with hardly any: to the point's own)...
  double max_relative_sigma = 0.4;
  /// ...or absolute, for points that are far away.
  double max_inverse_distance_sigma_per_m = 0.02;
  double max_error_sigmas = 4.0;  ///< observations with larger whitened errors are outliers

  /// Throws UsageError where a value is out of its range.
  void check() const;
};

struct SolverOptions {
  int max_iterations = 4;
  double function_tolerance = 3e-2;   ///< relative change of the cost that ends a frame's iterations
  double robust_scale_sigmas = 2.0;   ///< width of the Cauchy loss on reprojection residuals, at most...
  double robust_scale_medians = 2.5;  ///< ...and in medians of the residuals of a frame (robust_loss.h)
  bool track_weights = true;          ///< weight each track by its own residuals (robust_loss.h)

  /// Throws UsageError where a value is out of its range.
  void check() const;
};

/// Sigma of the calibration files' errors; a sigma of 0 holds the parameter. Without `intrinsics` the
/// intrinsics are constant. A wrong principal point acts like a camera rotation and is compensated as one,
/// but part of every rotation then counts as translation.
struct CameraCalibrationOptions {
  bool enabled = true;
  double rotation_sigma_rad = 0.01;  ///< camera 0 to the IMU, each axis
  double position_sigma_m = 0.01;
  double time_offset_sigma_s = 0.005;
  /// Secondary cameras relative to camera 0. Their distance is the main source of scale of a stereo rig. Most
  /// files state it accurately; others are wrong by as much as the assumed size of the calibration target
  /// (see FactorBuilder::placement).
  double stereo_rotation_sigma_rad = 0.003;
  double stereo_position_sigma_m = 3e-4;
  /// Whether the intrinsics are estimated as well (factors/intrinsics_factor.h), from the time the window has
  /// settled. At the start with one camera the scale is unknown, and images contain too little information
  /// about them.
  bool intrinsics = true;
  double focal_length_sigma = 0.003;  ///< relative
  double principal_point_sigma_px = 1.5;
  double radial_sigma = 0.005;  ///< of the first two coefficients
  double tangential_sigma = 0.003;
  double port_tilt_sigma = 0.012;  ///< of the coefficients of a tilted port; 0.012 for a tilt of 0.8 degrees
  /// Ports that the files state, in the batch solution. The axis of a lens is square to its mount, and the
  /// mount to the plate, within 0.2 mm over 25 mm each. The centre of projection is a few mm from where a
  /// ruler on the barrel of the lens puts it.
  double port_normal_sigma_rad = 0.01;   ///< flat: each axis
  double port_distance_sigma_m = 0.003;  ///< flat: distance; dome: each axis of the centre
  /// Whether the intrinsics and the rotations of secondary cameras are held at their files while images
  /// confirm these; see IntrinsicsModelSelection.
  bool trust_confirmed_files = true;

  /// Throws UsageError where a value is out of its range.
  void check() const;
};

/// Sigma of the errors in the calibration of the IMU.
struct ImuAxesOptions {
  /// Scale errors and misalignment of the axes of a gyroscope that its maker calibrated, relative
  /// (SensorAxes); 0 holds them. Some gyroscopes are calibrated to less than a thousandth, others never were
  /// and are wrong by one or two per cent. No single Gaussian describes both, see FactorBuilder::imuAxes().
  double gyroscope_sigma = imu_axes::kCalibratedSigma;
  /// Sigma of the axes of an IMU that may never have been calibrated (imu_axes::areCalibrated), where its
  /// calibration does not state one; 0: as for the others. It is also part of the reported tilt covariance
  /// throughout. Relative, and rad.
  double uncalibrated_sigma = imu_axes::kUncalibratedSigma;
  /// Reported sigma of such an IMU's initial accelerometer bias. Data sheets allow 0.6 to 0.8 m/s^2 (60 to 80
  /// mg, e.g. InvenSense MPU-9250, PS-MPU-9250A-01 rev. 1.1), here two sigmas. Most parts are far better, and
  /// the estimate itself uses InitialStateOptions.
  double uncalibrated_bias_sigma_m_per_s2 = 0.4;
  /// Axes errors of the worst sensors on the market: sensitivities that are 3 % off and axes misaligned by 2
  /// % (InvenSense MPU-9250, PS-MPU-9250A-01 rev. 1.1). It bounds the axes errors estimated from readings
  /// while no image contradicts them.
  double worst_sigma = 0.03;
  /// Like gyroscope_sigma, for the accelerometer.
  double accelerometer_sigma = imu_axes::kCalibratedSigma;
  /// Upper limit of motion_noise.axis_error where the axes of a calibrated IMU are states. It covers errors
  /// that no matrix describes, such as sensitivities that change with the rate or the force. Relative.
  double error_beside_states = 1e-3;

  bool areDoubted() const { return uncalibrated_sigma > 0.0; }
  /// Tilt error of an accelerometer beside its states, rad: makers calibrate both sensors or none.
  double accelerometerSigma() const { return std::max(gyroscope_sigma, uncalibrated_sigma); }

  /// Throws UsageError where a value is out of its range.
  void check() const;
};

/// Limits of StationaryDetector.
struct RestOptions {
  bool enabled = true;
  double span_s = 1.0;     ///< time for which readings and images must be at rest
  int min_tracks = 20;     ///< tracks that are observed throughout
  double shift_px = 0.15;  ///< median of the tracks' shifts over the span; larger where tracks are noisier
  double rate_deviation_rad_per_s = 0.02;  ///< deviation of readings from their means, beyond their noise
  double force_deviation_m_per_s2 = 0.1;
  double velocity_sigma_m_per_s = 0.03;  ///< sigma of the zero-velocity update

  /// Throws UsageError where a value is out of its range.
  void check() const;
};

struct EstimatorOptions {
  Vec3 gravity_W = standardGravity_W();  ///< m/s^2
  InitialStateOptions initial_state;
  MonoInitializationOptions mono_initialization;
  WindowOptions window;
  KeyframeOptions keyframe;
  LandmarkOptions landmark;
  SolverOptions solver;
  CameraCalibrationOptions camera_calibration;
  ImuAxesOptions imu_axes;
  RestOptions rest;
  PreintegrationOptions preintegration;
  MagnetometerOptions magnetometer;
  DepthOptions depth;
  SonarOptions sonar;
  DvlOptions dvl;
  GravityAlignmentOptions gravity_alignment;
  int min_landmarks_for_vision = 8;  ///< with fewer in view, a frame is propagated by inertial readings

  /// Throws UsageError where a value is out of its range.
  void check() const;
};

}  // namespace lodeline
