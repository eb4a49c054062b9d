#pragma once

#include <algorithm>

#include "lodeline/estimator/options/depth_options.h"
#include "lodeline/estimator/options/magnetometer_options.h"
#include "lodeline/geometry/types.h"
#include "lodeline/imu/gravity.h"
#include "lodeline/imu/gravity_alignment.h"
#include "lodeline/imu/preintegration.h"

namespace lodeline {

/// How sure we are of the state that the first frame starts from; standard deviations.
struct InitialStateOptions {
  double alignment_window_s = 1.0;  ///< inertial readings before the first frame that give the tilt
  int min_stereo_tracks = 20;
  double position_sigma_m = 1e-4;  ///< with the heading's: the origin of the world, hence tiny
  double yaw_sigma_rad = 1e-4;
  double tilt_sigma_min_rad = 0.01;
  double velocity_sigma_m_per_s = 1.0;
  double gyroscope_bias_sigma_rad_per_s = 0.1;
  double accelerometer_bias_sigma_m_per_s2 = 0.2;
};

struct MonoInitializationOptions {
  double min_frame_distance_s = 0.08;  ///< images in between are left out
  double max_duration_s = 5.0;         ///< a slow swimmer sees far points turn by 10 px only after some way
  int min_frames = 6;
  int min_common_tracks = 20;  ///< seen by the oldest and the newest frame
  double min_parallax_px = 5.0;
  double max_epipolar_error_px = 1.0;
  /// How far gravity may come out from its true magnitude when the alignment leaves it free.
  double gravity_tolerance_m_per_s2 = 1.0;
  double start_tilt_sigma_rad = 0.3;
  int max_iterations = 100;
  double max_bias_sigmas = 4.0;  ///< a larger accelerometer bias is taken for a false minimum
  /// Mean square of the whitened inertial errors; more is taken for a false minimum.
  double max_inertial_disagreement = 1.5;
  double max_scale_sigma = 0.1;  ///< relative; wait on while the scale is known worse
  double retry_after_s = 0.2;    ///< a start that was refused has cost a second of computing
};

struct WindowOptions {
  int recent_frames = 5;  ///< newest frames, kept with velocity and biases
  int keyframes = 12;     ///< older keyframes, kept as poses
  /// When a landmark outlives the oldest keyframe, its observations before the newest so many of the older
  /// keyframes go into the prior, and it goes on as another point with the rest.
  int split_at_keyframe = 2;
  /// Between keyframes of at most this distance in time the observations of other frames are kept, so far
  /// apart in time.
  double interpolated_gap_s = 1.6;
  double interpolated_spacing_s = 0.18;
  /// Landmarks that no recent frame sees are evaluated anew after so many frames; 0: in every frame.
  int frozen_frames = 8;
  /// Nothing is marginalized before this many frames, so that no early, bad linearization is frozen. One
  /// camera, whose scale settles slowly, waits longer, and until the scale is known to `startup_scale_sigma`
  /// (relative). After `startup_max_frames` frames go all the same, but no linearization is kept until it is.
  int startup_frames = 20;
  int startup_frames_mono = 45;
  int startup_max_frames = 60;
  double startup_scale_sigma = 0.03;
};

struct KeyframeOptions {
  double min_tracked_share = 0.7;  ///< of the last keyframe's landmarks still seen
  double min_parallax_rad = 0.02;  ///< median rotation-free shift of the common tracks
  /// Parallax asks for one no sooner: the window of a fast rig must span some time, or landmarks outlive it.
  double min_interval_s = 0.24;
  int min_landmarks = 30;  ///< fewer seen landmarks ask for a keyframe
  /// A frame that sees little becomes a keyframe only when this share of its tracks is new since the last
  /// one.
  double min_fresh_share = 0.2;
};

struct LandmarkOptions {
  int max_landmarks = 200;
  /// As long as fewer are seen, new points become landmarks however many the window holds: after darkness it
  /// may be full of those that were seen before.
  int least_in_view = 50;
  /// Seen by so many frames, as soon as the window has them. Where there is nothing to see (silt, darkness
  /// full of the blocks of a compressed video, particles in the lamp's light), what is followed from one
  /// image to the next is chance. Two views make a place in space of any such point, and hundreds hold the
  /// rig back.
  int min_frames = 3;
  double min_distance_m = 0.05;
  /// Largest sigma of the inverse distance at which a point becomes a landmark, relative to the usual one of
  /// the landmarks in view (of a window with hardly any: to the point's own)...
  double max_relative_sigma = 0.4;
  /// ...or absolute, for points that are far away.
  double max_inverse_distance_sigma_per_m = 0.02;
  double max_error_sigmas = 4.0;  ///< observations with larger whitened errors are outliers
};

struct SolverOptions {
  int max_iterations = 4;
  double function_tolerance = 3e-2;   ///< relative change of the cost that ends a frame's iterations
  double robust_scale_sigmas = 2.0;   ///< width of the Cauchy loss on reprojection errors, at most...
  double robust_scale_medians = 2.5;  ///< ...and in medians of those of a frame (robust_loss.h)
  bool track_weights = true;          ///< weigh each track by what its own errors say of it (robust_loss.h)
};

/// How far the camera calibration of the files may be off, one sigma; a sigma of 0 holds it. Without
/// `intrinsics` the lens is left alone: a wrong principal point looks like a turned camera, and is made good
/// as one, but part of every turn then counts as way.
struct CameraCalibrationOptions {
  bool enabled = true;
  double rotation_sigma_rad = 0.01;  ///< camera 0 to the IMU, each axis
  double position_sigma_m = 0.01;
  double time_offset_sigma_s = 0.005;
  /// Further cameras to camera 0. Their distance is the first ruler of a stereo rig, and files state it well,
  /// or as wrong as the length of the calibration target was (see FactorBuilder::placement).
  double stereo_rotation_sigma_rad = 0.003;
  double stereo_position_sigma_m = 3e-4;
  /// The lens as well (factors/intrinsics_factor.h), as soon as the window has settled: the start of one
  /// camera, whose scale is not known yet, tells too little of it.
  bool intrinsics = true;
  double focal_length_sigma = 0.003;  ///< relative
  double principal_point_sigma_px = 1.5;
  double radial_sigma = 0.005;  ///< of the first two coefficients
  /// Whether lenses and how secondary cameras are turned are held at their files while images confirm these,
  /// see IntrinsicsModelSelection.
  bool trust_confirmed_files = true;
};

/// How far the calibration of the IMU may be off, one sigma.
struct ImuAxesOptions {
  /// Scale errors and misalignment of the axes of a gyroscope that its maker has calibrated, relative
  /// (SensorAxes); 0 holds them. Some are, to less than a thousandth, and some never were and are off by
  /// one or two per cent: no Gaussian describes both, see FactorBuilder::imuAxes().
  double gyroscope_sigma = imu_axes::kCalibratedSigma;
  /// Makers calibrate the axes of their better sensors: of an IMU whose gyroscope has less white noise than
  /// this, no more than `gyroscope_sigma` is doubted.
  double calibrated_below_rad_per_s_sqrtHz = imu_axes::kCalibratedBelow_rad_per_s_sqrtHz;
  /// Of the axes of an IMU above that, which may never have been calibrated; 0: no more than of others. It is
  /// also claimed of what the accelerometer takes for up throughout. Relative, and rad.
  double uncalibrated_sigma = imu_axes::kUncalibratedSigma;
  /// What is claimed of such an IMU's accelerometer bias at the start. Data sheets allow of 0.6 to 0.8 m/s^2
  /// (60 to 80 mg, e.g. InvenSense MPU-9250, PS-MPU-9250A-01 rev. 1.1), here two sigmas; most parts are far
  /// better, and a start is estimated by InitialStateOptions.
  double uncalibrated_bias_sigma_m_per_s2 = 0.4;
  /// Of the worst sensors that are sold: sensitivities that are 3 % off and axes that are 2 % aside
  /// (InvenSense MPU-9250, PS-MPU-9250A-01 rev. 1.1). Bounds what readings make of axes while no image
  /// contradicts.
  double worst_sigma = 0.03;
  /// As gyroscope_sigma, of the accelerometer.
  double accelerometer_sigma = imu_axes::kCalibratedSigma;
  /// Where the axes of a calibrated IMU are states, motion_noise.axis_error counts for no more than this:
  /// what no matrix describes, such as sensitivities that change with the rate or with the force. Relative.
  double error_beside_states = 1e-3;

  bool areDoubted() const { return uncalibrated_sigma > 0.0; }
  /// Of what an accelerometer takes for up beside its states: makers calibrate both sensors or none.
  double accelerometerSigma() const { return std::max(gyroscope_sigma, uncalibrated_sigma); }
};

/// When a rig counts as resting, see StationaryDetector.
struct RestOptions {
  bool enabled = true;
  double span_s = 1.0;     ///< readings and images rest for so long
  int min_tracks = 20;     ///< that are seen throughout
  double shift_px = 0.15;  ///< median of the tracks' shifts over the span; more where tracks are noisier
  double rate_deviation_rad_per_s = 0.02;  ///< of readings from their means, on top of their noise
  double force_deviation_m_per_s2 = 0.1;
  double velocity_sigma_m_per_s = 0.03;  ///< what may be left of motion
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
  GravityAlignmentOptions gravity_alignment;
  int min_landmarks_for_vision = 8;  ///< fewer seen landmarks mean that a frame is carried inertially
};

}  // namespace lodeline
