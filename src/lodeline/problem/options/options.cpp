#include "lodeline/problem/options/options.h"

#include "lodeline/util/settings/option_check.h"

namespace lodeline {

void InitialStateOptions::check() const {
  OptionCheck("start")
      .positive("alignment_window_s", alignment_window_s)
      .atLeast("min_stereo_tracks", min_stereo_tracks, 1)
      .positive("position_sigma_m", position_sigma_m)
      .positive("yaw_sigma_rad", yaw_sigma_rad)
      .positive("tilt_sigma_min_rad", tilt_sigma_min_rad)
      .positive("velocity_sigma_m_per_s", velocity_sigma_m_per_s)
      .positive("gyroscope_bias_sigma_rad_per_s", gyroscope_bias_sigma_rad_per_s)
      .positive("accelerometer_bias_sigma_m_per_s2", accelerometer_bias_sigma_m_per_s2);
}

void MonoInitializationOptions::check() const {
  OptionCheck("start.mono")
      .notNegative("min_frame_distance_s", min_frame_distance_s)
      .positive("max_duration_s", max_duration_s)
      .atLeast("min_frames", min_frames, 2)
      .atLeast("min_common_tracks", min_common_tracks, 5)
      .notNegative("min_parallax_px", min_parallax_px)
      .positive("max_epipolar_error_px", max_epipolar_error_px)
      .positive("gravity_tolerance_m_per_s2", gravity_tolerance_m_per_s2)
      .positive("start_tilt_sigma_rad", start_tilt_sigma_rad)
      .atLeast("max_iterations", max_iterations, 1)
      .positive("max_bias_sigmas", max_bias_sigmas)
      .positive("max_inertial_disagreement", max_inertial_disagreement)
      .positive("max_scale_sigma", max_scale_sigma)
      .notNegative("retry_after_s", retry_after_s);
}

void WindowOptions::check() const {
  OptionCheck("window")
      .atLeast("recent_frames", recent_frames, 2)
      .notNegative("keyframes", keyframes)
      .notNegative("split_at_keyframe", split_at_keyframe)
      .notNegative("interpolated_gap_s", interpolated_gap_s)
      .notNegative("interpolated_spacing_s", interpolated_spacing_s)
      .notNegative("frozen_frames", frozen_frames)
      .notNegative("startup_frames", startup_frames)
      .notNegative("startup_frames_mono", startup_frames_mono)
      .notNegative("startup_max_frames", startup_max_frames)
      .positive("startup_scale_sigma", startup_scale_sigma);
}

void KeyframeOptions::check() const {
  OptionCheck("keyframe")
      .within("min_tracked_share", min_tracked_share, 0.0, 1.0)
      .notNegative("min_parallax_rad", min_parallax_rad)
      .notNegative("min_interval_s", min_interval_s)
      .notNegative("min_landmarks", min_landmarks)
      .within("min_fresh_share", min_fresh_share, 0.0, 1.0);
}

void LandmarkOptions::check() const {
  OptionCheck("landmark")
      .atLeast("max_landmarks", max_landmarks, 1)
      .notNegative("least_in_view", least_in_view)
      .atLeast("min_frames", min_frames, 1)
      .notNegative("min_distance_m", min_distance_m)
      .positive("max_relative_sigma", max_relative_sigma)
      .positive("max_inverse_distance_sigma_per_m", max_inverse_distance_sigma_per_m)
      .positive("max_error_sigmas", max_error_sigmas);
}

void SolverOptions::check() const {
  OptionCheck("solver")
      .atLeast("max_iterations", max_iterations, 1)
      .notNegative("function_tolerance", function_tolerance)
      .positive("robust_scale_sigmas", robust_scale_sigmas)
      .positive("robust_scale_medians", robust_scale_medians);
}

void CameraCalibrationOptions::check() const {
  OptionCheck("camera_calibration")
      .notNegative("rotation_sigma_rad", rotation_sigma_rad)
      .notNegative("position_sigma_m", position_sigma_m)
      .notNegative("time_offset_sigma_s", time_offset_sigma_s)
      .notNegative("stereo_rotation_sigma_rad", stereo_rotation_sigma_rad)
      .notNegative("stereo_position_sigma_m", stereo_position_sigma_m)
      .notNegative("focal_length_sigma", focal_length_sigma)
      .notNegative("principal_point_sigma_px", principal_point_sigma_px)
      .notNegative("radial_sigma", radial_sigma)
      .notNegative("tangential_sigma", tangential_sigma)
      .notNegative("port_tilt_sigma", port_tilt_sigma)
      .notNegative("port_normal_sigma_rad", port_normal_sigma_rad)
      .notNegative("port_distance_sigma_m", port_distance_sigma_m);
}

void ImuAxesOptions::check() const {
  OptionCheck("inertial")
      .notNegative("gyroscope_sigma", gyroscope_sigma)
      .notNegative("uncalibrated_sigma", uncalibrated_sigma)
      .notNegative("uncalibrated_bias_sigma_m_per_s2", uncalibrated_bias_sigma_m_per_s2)
      .positive("worst_sigma", worst_sigma)
      .notNegative("accelerometer_sigma", accelerometer_sigma)
      .notNegative("error_beside_states", error_beside_states);
}

void RestOptions::check() const {
  OptionCheck("zero_velocity")
      .positive("span_s", span_s)
      .atLeast("min_tracks", min_tracks, 1)
      .notNegative("shift_px", shift_px)
      .notNegative("rate_deviation_rad_per_s", rate_deviation_rad_per_s)
      .notNegative("force_deviation_m_per_s2", force_deviation_m_per_s2)
      .positive("velocity_sigma_m_per_s", velocity_sigma_m_per_s);
}

void EstimatorOptions::check() const {
  OptionCheck("estimator")
      .atLeast("min_landmarks_for_vision", min_landmarks_for_vision, 1)
      .positive("gravity", gravity_W.norm());
  initial_state.check();
  mono_initialization.check();
  window.check();
  keyframe.check();
  landmark.check();
  solver.check();
  camera_calibration.check();
  imu_axes.check();
  rest.check();
  magnetometer.check();
  depth.check();
  sonar.check();
  dvl.check();
}

}  // namespace lodeline
