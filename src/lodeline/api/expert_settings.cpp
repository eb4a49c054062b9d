#include "lodeline/api/expert_settings.h"

namespace lodeline {
namespace {

void bindSource(Settings* settings, SynchronizerOptions* synchronizer) {
  settings->bind("expert.source.camera_match_tolerance_s", &synchronizer->match_tolerance_s,
                 "An image of a secondary camera belongs to an image of the first camera when their times "
                 "differ by no more than this. Half a frame period is the limit in any case.");
  settings->bind("expert.source.prefetch", &synchronizer->prefetch,
                 "Decode the next images on other threads while the estimator works. The results are the "
                 "same without it.");
}

void bindFrontEnd(Settings* settings, OdometryOptions* odometry) {
  FrontEndOptions* options = &odometry->front_end;
  settings->bind("expert.front_end.max_tracks", &odometry->max_tracks,
                 "Largest number of points that are followed at a time. `0` takes 180 with calibrated axes "
                 "of the IMU, else 250.");
  settings->bind("expert.front_end.static_image_mask", &options->static_image_mask.enabled,
                 "Leave out regions that stay in place in the images, such as parts of the rig.");
  settings->bind("expert.front_end.min_distance_px", &options->detector.min_distance_px,
                 "Least distance between two points.");
  settings->bind("expert.front_end.max_stereo_epipolar_px", &options->stereo.max_epipolar_px,
                 "Largest distance of a stereo match from its epipolar line. A quarter of a degree is used "
                 "where that is more.");
  settings->bind("expert.front_end.max_epipolar_px", &options->consensus.max_error_px,
                 "Points that disagree with the motion of the other points by more than this are outliers.");
  settings->bind("expert.front_end.seed", &options->consensus.seed,
                 "Seed of the random choices of the outlier test.");
  settings->bind("expert.front_end.sigma_px", &options->sigma_px,
                 "Standard deviation of the image position of a point.", Settings::Sign::Positive);
  settings->bind("expert.front_end.learn_stereo_rotation", &options->stereo.learn_rotation,
                 "Estimate the rotation of a secondary camera against its file from stereo matches. Works "
                 "only while the camera calibration is estimated.");
}

void bindInertial(Settings* settings, PreintegrationOptions* options, ImuAxesOptions* calibration) {
  settings->bind("expert.inertial.gyroscope_axes_sigma", &calibration->gyroscope_sigma,
                 "Relative scale errors and misalignment of the axes of a calibrated gyroscope. `0` does not "
                 "estimate the axes.");
  settings->bind("expert.inertial.accelerometer_axes_sigma", &calibration->accelerometer_sigma,
                 "Relative scale errors and misalignment of the axes of a calibrated accelerometer. `0` does "
                 "not estimate the axes.");
  settings->bind("expert.inertial.noise_inflation", &options->noise_inflation,
                 "Factor on all noise densities of the IMU calibration.", Settings::Sign::Positive);
}

void bindWindow(Settings* settings, EstimatorOptions* options) {
  settings->bind("expert.window.recent_frames", &options->window.recent_frames,
                 "Number of newest frames that keep velocity and biases.", 2);
  settings->bind("expert.window.keyframes", &options->window.keyframes, "Number of older keyframes.");
  settings->bind("expert.window.frozen_frames", &options->window.frozen_frames,
                 "Number of frames after which landmarks that no recent frame sees are linearized again. `0` "
                 "linearizes them in every frame.");
  settings->bind("expert.window.interpolated_gap_s", &options->window.interpolated_gap_s,
                 "The window keeps observations of frames between two keyframes that are no further apart "
                 "than this. `0` keeps none.");
  settings->bind("expert.window.split_at_keyframe", &options->window.split_at_keyframe,
                 "A landmark that outlives the oldest keyframe is split. Its observations in this number of "
                 "the newest older keyframes stay in the window. The others go into the prior.");
  settings->bind(
      "expert.keyframe.min_parallax_rad", &options->keyframe.min_parallax_rad,
      "A frame becomes a keyframe when the median shift of the points, with rotation removed, is larger.");
  settings->bind("expert.landmark.max_count", &options->landmark.max_landmarks,
                 "Largest number of landmarks in the window.");
}

void bindCameraCalibration(Settings* settings, CameraCalibrationOptions* cameras) {
  settings->bind("expert.camera_calibration.enabled", &cameras->enabled,
                 "Estimate the calibration of the cameras.");
  settings->bind("expert.camera_calibration.rotation_sigma_rad", &cameras->rotation_sigma_rad,
                 "Rotation of camera 0 against the IMU. `0` keeps it fixed.");
  settings->bind("expert.camera_calibration.position_sigma_m", &cameras->position_sigma_m,
                 "Position of camera 0 against the IMU. `0` keeps it fixed.");
  settings->bind("expert.camera_calibration.time_offset_sigma_s", &cameras->time_offset_sigma_s,
                 "Time offset of the images against the IMU. `0` keeps it fixed.");
  settings->bind("expert.camera_calibration.stereo_rotation_sigma_rad", &cameras->stereo_rotation_sigma_rad,
                 "Rotation of secondary cameras against camera 0. `0` keeps it fixed.");
  settings->bind("expert.camera_calibration.stereo_position_sigma_m", &cameras->stereo_position_sigma_m,
                 "Position of secondary cameras against camera 0. `0` keeps it fixed.");
  settings->bind("expert.camera_calibration.intrinsics", &cameras->intrinsics,
                 "Estimate the intrinsics too.");
  settings->bind("expert.camera_calibration.focal_length_sigma", &cameras->focal_length_sigma,
                 "Relative error of both focal lengths. `0` keeps them fixed.");
  settings->bind("expert.camera_calibration.principal_point_sigma_px", &cameras->principal_point_sigma_px,
                 "Error of the principal point. `0` keeps it fixed.");
  settings->bind("expert.camera_calibration.radial_sigma", &cameras->radial_sigma,
                 "Error of the first two radial distortion coefficients. `0` keeps them fixed.");
  settings->bind("expert.camera_calibration.tangential_sigma", &cameras->tangential_sigma,
                 "Error of both tangential distortion coefficients. `0` keeps them fixed.");
  settings->bind(
      "expert.camera_calibration.port_tilt_sigma", &cameras->port_tilt_sigma,
      "Effect of a tilted port that the lens of the file does not contain. `0.012` is a tilt of 0.8 "
      "degrees, `0` none.");
  settings->bind("expert.camera_calibration.port_normal_sigma_rad", &cameras->port_normal_sigma_rad,
                 "`refine`: normal of a flat port in the rig file. `0` keeps it fixed.");
  settings->bind(
      "expert.camera_calibration.port_distance_sigma_m", &cameras->port_distance_sigma_m,
      "`refine`: distance of a flat port in the rig file, or centre of a dome. `0` keeps it fixed.");
  settings->bind("expert.camera_calibration.trust_confirmed_files", &cameras->trust_confirmed_files,
                 "Keep intrinsics and stereo rotation fixed at the values of their files while the images "
                 "confirm them.");
}

void bindSolver(Settings* settings, EstimatorOptions* options) {
  settings->bind("expert.solver.max_iterations", &options->solver.max_iterations,
                 "Largest number of iterations for a frame.", 1);
  settings->bind("expert.solver.robust_scale_sigmas", &options->solver.robust_scale_sigmas,
                 "Upper limit of the width of the Cauchy loss, in standard deviations of an observation.");
  settings->bind("expert.solver.track_weights", &options->solver.track_weights,
                 "Weight the observations of a track by the errors of that track.");
  settings->bind("expert.zero_velocity.enabled", &options->rest.enabled,
                 "Detect a rig at rest and use a velocity of zero as a measurement.");
}

void bindMagnetometer(Settings* settings, MagnetometerOptions* options) {
  settings->bind("expert.magnetometer.noise_inflation", &options->noise_inflation,
                 "Factor on the noise density of the magnetometer.");
  settings->bind("expert.magnetometer.student_dof", &options->student_dof,
                 "Degrees of freedom of the Student distribution of the time-correlated field error.");
  settings->bind("expert.magnetometer.offset_sigma_T", &options->offset_sigma_T,
                 "Hard iron that appears between calibration and dive.");
  settings->bind("expert.magnetometer.uncalibrated_offset_sigma_T", &options->uncalibrated_offset_sigma_T,
                 "Hard iron of a magnetometer that was never calibrated.");
  settings->bind("expert.magnetometer.step.enabled", &options->step.enabled,
                 "Correct the readings by the field of switched currents.");
}

void bindMagnetometerGate(Settings* settings, MagnetometerGateOptions* gate) {
  settings->bind("expert.magnetometer.gate.max_norm_error", &gate->max_norm_error,
                 "Largest relative error of the size of the field.");
  settings->bind("expert.magnetometer.gate.max_dip_error_rad", &gate->max_dip_error_rad,
                 "Largest error of the dip.");
  settings->bind("expert.magnetometer.gate.max_sigmas", &gate->max_sigmas,
                 "Largest innovation of the heading, in standard deviations.");
}

void bindDepth(Settings* settings, DepthOptions* options) {
  settings->bind("expert.pressure.use", &options->use, "Use the pressure sensor.");
  settings->bind("expert.pressure.density_ratio_sigma", &options->density_ratio_sigma,
                 "Uncertainty of `pressure.density_ratio`. `0` keeps it fixed.");
  settings->bind(
      "expert.pressure.water_density_prior", &options->water_density_prior,
      "Use the knowledge that most water is fresh or salt, and most sensors are set to one of both.");
  settings->bind("expert.pressure.lag_s", &options->lag_s, "Time constant of the pressure sensor.");
  settings->bind("expert.pressure.noise_inflation", &options->noise_inflation,
                 "Factor on `depth_noise_std` of the calibration of the pressure sensor.");
}

void bindSonar(Settings* settings, SonarOptions* options) {
  settings->bind("expert.sonar.use", &options->use, "Use the ranges of sonar, altimeter and DVL.");
  settings->bind("expert.sonar.noise_inflation", &options->noise_inflation,
                 "Factor on `range_noise_std` of the calibrations of sonar, altimeter and DVL.",
                 Settings::Sign::Positive);
}

void bindDvl(Settings* settings, DvlOptions* options) {
  settings->bind("expert.dvl.use", &options->use, "Use the velocities of the DVL.");
  settings->bind("expert.dvl.noise_inflation", &options->noise_inflation,
                 "Factor on the noise of the velocities that the calibration of the DVL states.",
                 Settings::Sign::Positive);
}

}  // namespace

void bindExpertSettings(Settings* settings, RunSettings* options) {
  EstimatorOptions* estimator = &options->odometry.estimator;
  bindSource(settings, &options->synchronizer);
  bindFrontEnd(settings, &options->odometry);
  bindInertial(settings, &estimator->preintegration, &estimator->imu_axes);
  bindWindow(settings, estimator);
  bindCameraCalibration(settings, &estimator->camera_calibration);
  bindSolver(settings, estimator);
  bindMagnetometer(settings, &estimator->magnetometer);
  bindMagnetometerGate(settings, &estimator->magnetometer.gate);
  bindDepth(settings, &estimator->depth);
  bindSonar(settings, &estimator->sonar);
  bindDvl(settings, &estimator->dvl);
}

}  // namespace lodeline
