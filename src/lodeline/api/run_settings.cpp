#include "lodeline/api/run_settings.h"

#include <fmt/core.h>

#include "lodeline/diagnostics.h"
#include "lodeline/magnetometer/earth_field/world_magnetic_model.h"

namespace lodeline {
namespace {

void bindSource(Settings* settings, EurocOptions* source, SynchronizerOptions* synchronizer) {
  settings->bind("source.cameras", &source->camera_indices,
                 "cameras to use, by number; the first is the reference; [] for all");
  settings->bind("source.skip_s", &synchronizer->skip_s, "leave out the images of the first so many seconds");
  settings->bind("source.duration_s", &synchronizer->duration_s, "end after so many seconds; 0 for all");
  settings->bind("source.camera_match_tolerance_s", &synchronizer->match_tolerance_s,
                 "images of other cameras belong to the first camera's when this close");
  settings->bind("source.max_gap_periods", &synchronizer->max_gap_periods,
                 "report silence of a sensor longer than this many periods");
  settings->bind("source.prefetch", &synchronizer->prefetch,
                 "decode the next images while the present are worked on");
}

void bindFrontEnd(Settings* settings, FrontEndOptions* options, int* max_tracks) {
  settings->bind(
      "front_end.max_tracks", max_tracks,
      "points followed at a time; 0: 180 where the maker is taken to have calibrated the IMU, else 250");
  settings->bind("front_end.min_distance_px", &options->detector.min_distance_px,
                 "between new points and others");
  settings->bind("front_end.min_gradient_grey_per_px", &options->detector.min_gradient_grey_per_px,
                 "weakest texture that a point may have");
  settings->bind("front_end.pyramid_levels", &options->pyramid_levels, "halvings of the image plus one", 1);
  settings->bind("front_end.max_forward_backward_px", &options->tracker.max_forward_backward_px,
                 "largest error when a point is followed back");
  settings->bind(
      "front_end.max_stereo_epipolar_px", &options->stereo.max_epipolar_px,
      "largest distance of a stereo match from its epipolar line; a quarter of a degree where that "
      "is more");
  settings->bind("front_end.learn_stereo_rotation", &options->stereo.learn_rotation,
                 "find out from stereo matches how a camera is turned against its file; only while the "
                 "cameras' calibration is estimated");
  settings->bind("front_end.min_depth_m", &options->stereo.min_depth_m,
                 "nearest point that stereo matching looks for");
  settings->bind("front_end.max_epipolar_px", &options->consensus.max_error_px,
                 "largest disagreement of a point with the motion of the others");
  settings->bind("front_end.seed", &options->consensus.seed,
                 "of the random choices in that judgement; another one makes another, equally good run");
  settings->bind("front_end.max_gap_s", &options->max_gap_s, "images missing for longer end all tracks");
  settings->bind("front_end.static_image_mask", &options->static_image_mask.enabled,
                 "leave out what stays at its place in the images, such as parts of the rig");
  settings->bind("front_end.sigma_px", &options->sigma_px, "standard deviation of an observation",
                 Settings::Sign::Positive);
}

void bindInertial(Settings* settings, PreintegrationOptions* options, ImuAxesOptions* calibration) {
  settings->bind("inertial.gyroscope_axes_sigma", &calibration->gyroscope_sigma,
                 "relative scale errors and misalignment of a calibrated gyroscope's axes; 0: not estimated");
  settings->bind("inertial.accelerometer_axes_sigma", &calibration->accelerometer_sigma,
                 "the same of a calibrated accelerometer's");
  settings->bind("inertial.calibrated_below_rad_per_s_sqrtHz",
                 &calibration->calibrated_below_rad_per_s_sqrtHz,
                 "white noise of a gyroscope below which its maker is taken to have calibrated the IMU");
  settings->bind("inertial.uncalibrated_sigma", &calibration->uncalibrated_sigma,
                 "of the axes of an IMU above that, which was perhaps never calibrated");
  settings->bind("inertial.uncalibrated_bias_sigma_m_per_s2", &calibration->uncalibrated_bias_sigma_m_per_s2,
                 "of the accelerometer's bias of such an IMU at the start, likewise");
  settings->bind("inertial.noise_inflation", &options->noise_inflation,
                 "factor on all noise densities of the IMU's calibration", Settings::Sign::Positive);
  settings->bind("inertial.unresolved_share", &options->motion_noise.unresolved_share,
                 "of the change between two readings that counts as unknown");
  settings->bind("inertial.axis_error", &options->motion_noise.axis_error,
                 "relative scale errors and misalignment of the IMU's axes as noise");
  settings->bind("inertial.error_beside_axes", &calibration->error_beside_states,
                 "of that at most, where a calibrated IMU's axes are estimated");
  settings->bind("inertial.axis_error_time_s", &options->motion_noise.axis_error_time_s,
                 "for which an axis error keeps its effect");
  settings->bind("inertial.max_gap_s", &options->max_gap_s, "readings further apart count as lost data");
  settings->bind("inertial.gap_rate_sigma_rad_per_s", &options->gap_rate_sigma_rad_per_s,
                 "uncertainty of the rate over lost data");
  settings->bind("inertial.gap_specific_force_sigma_m_per_s2", &options->gap_specific_force_sigma_m_per_s2,
                 "uncertainty of the specific force over lost data");
}

void bindStart(Settings* settings, InitialStateOptions* start, MonoInitializationOptions* mono) {
  settings->bind("start.alignment_window_s", &start->alignment_window_s,
                 "inertial readings that give the first tilt");
  settings->bind("start.min_stereo_tracks", &start->min_stereo_tracks, "stereo matches that a start takes");
  settings->bind("start.velocity_sigma_m_per_s", &start->velocity_sigma_m_per_s, "of the start");
  settings->bind("start.gyroscope_bias_sigma_rad_per_s", &start->gyroscope_bias_sigma_rad_per_s,
                 "turn-on bias");
  settings->bind("start.accelerometer_bias_sigma_m_per_s2", &start->accelerometer_bias_sigma_m_per_s2,
                 "turn-on bias");
  settings->bind("start.mono.min_parallax_px", &mono->min_parallax_px, "that visual structure takes");
  settings->bind("start.mono.min_common_tracks", &mono->min_common_tracks, "of the first and the last image");
  settings->bind("start.mono.max_duration_s", &mono->max_duration_s, "longest stretch that is looked at");
  settings->bind("start.mono.max_scale_sigma", &mono->max_scale_sigma,
                 "relative; wait on while it is larger");
}

void bindEstimator(Settings* settings, EstimatorOptions* options) {
  settings->bind("window.recent_frames", &options->window.recent_frames,
                 "newest frames, with velocity and biases", 2);
  settings->bind("window.keyframes", &options->window.keyframes, "older keyframes");
  settings->bind("window.split_at_keyframe", &options->window.split_at_keyframe,
                 "of these, whose observations a landmark goes on with that outlives the oldest one");
  settings->bind("window.interpolated_spacing_s", &options->window.interpolated_spacing_s,
                 "at least, of frames between keyframes whose observations are kept");
  settings->bind("window.interpolated_gap_s", &options->window.interpolated_gap_s,
                 "at most, of the keyframes on both sides of them");
  settings->bind("window.frozen_frames", &options->window.frozen_frames,
                 "after which landmarks that no recent frame sees are evaluated anew; 0: in each");
  settings->bind("window.startup_frames", &options->window.startup_frames, "nothing is marginalized before");
  settings->bind("window.startup_frames_mono", &options->window.startup_frames_mono,
                 "the same with one camera");
  settings->bind("keyframe.min_tracked_share", &options->keyframe.min_tracked_share,
                 "of the last keyframe's landmarks; fewer ask for a keyframe");
  settings->bind("keyframe.min_parallax_rad", &options->keyframe.min_parallax_rad,
                 "more asks for a keyframe");
  settings->bind("keyframe.min_interval_s", &options->keyframe.min_interval_s, "but no sooner");
  settings->bind("keyframe.min_landmarks", &options->keyframe.min_landmarks, "fewer ask for a keyframe");
  settings->bind("landmark.max_count", &options->landmark.max_landmarks, "in the window");
  settings->bind("landmark.least_in_view", &options->landmark.least_in_view,
                 "new ones are made for as long as fewer are seen, however many the window holds");
  settings->bind("landmark.min_frames", &options->landmark.min_frames, "that see a point before it counts");
  settings->bind("landmark.min_distance_m", &options->landmark.min_distance_m,
                 "nearer ones are taken for errors");
  settings->bind("landmark.max_error_sigmas", &options->landmark.max_error_sigmas,
                 "observations beyond are outliers");
  CameraCalibrationOptions* cameras = &options->camera_calibration;
  settings->bind("camera_calibration.enabled", &cameras->enabled,
                 "refine the cameras' calibration on the way");
  settings->bind("camera_calibration.rotation_sigma_rad", &cameras->rotation_sigma_rad,
                 "of camera 0 to the IMU; 0 holds it");
  settings->bind("camera_calibration.position_sigma_m", &cameras->position_sigma_m,
                 "of camera 0 to the IMU; 0 holds it");
  settings->bind("camera_calibration.time_offset_sigma_s", &cameras->time_offset_sigma_s,
                 "of the images' stamps; 0 holds it");
  settings->bind("camera_calibration.stereo_rotation_sigma_rad", &cameras->stereo_rotation_sigma_rad,
                 "of secondary cameras to camera 0; 0 holds it");
  settings->bind("camera_calibration.stereo_position_sigma_m", &cameras->stereo_position_sigma_m,
                 "of secondary cameras to camera 0; 0 holds it");
  settings->bind("camera_calibration.intrinsics", &cameras->intrinsics, "refine the lenses as well");
  settings->bind("camera_calibration.focal_length_sigma", &cameras->focal_length_sigma,
                 "relative, of both focal lengths; 0 holds them");
  settings->bind("camera_calibration.principal_point_sigma_px", &cameras->principal_point_sigma_px,
                 "0 holds it");
  settings->bind("camera_calibration.radial_sigma", &cameras->radial_sigma,
                 "of the first two radial coefficients of the lens' model; 0 holds them");
  settings->bind(
      "camera_calibration.trust_confirmed_files", &cameras->trust_confirmed_files,
      "hold lenses and how secondary cameras are turned at their files while images confirm these");
  settings->bind("solver.max_iterations", &options->solver.max_iterations, "a frame", 1);
  settings->bind("solver.function_tolerance", &options->solver.function_tolerance,
                 "relative gain below which a frame's iterations end");
  settings->bind(
      "solver.robust_scale_medians", &options->solver.robust_scale_medians,
      "width of the Cauchy loss, in medians of a frame's reprojection errors; heavy tails narrow it");
  settings->bind("solver.robust_scale_sigmas", &options->solver.robust_scale_sigmas, "the same, at most");
  settings->bind("solver.track_weights", &options->solver.track_weights,
                 "weigh each track's observations by what its own errors say of it");
  settings->bind("rest.enabled", &options->rest.enabled,
                 "count the velocity as none where readings and images rest");
  settings->bind("rest.velocity_sigma_m_per_s", &options->rest.velocity_sigma_m_per_s,
                 "what may be left of motion then");
  settings->bind("min_landmarks_for_vision", &options->min_landmarks_for_vision,
                 "with fewer a frame counts as carried by inertial readings alone");
}

void bindMagnetometer(Settings* settings, MagnetometerOptions* options) {
  settings->bind("magnetometer.model", &options->use,
                 {{"automatic", MagnetometerUse::Automatic},
                  {"absolute", MagnetometerUse::Absolute},
                  {"paper", MagnetometerUse::Paper},
                  {"off", MagnetometerUse::Off}},
                 "automatic: absolute where the magnetometer is calibrated, else off");
  settings->bind("magnetometer.correlated_noise_sigma_T", &options->correlated_noise_sigma_T,
                 "lasting errors of the field, one sigma per axis, to start with");
  settings->bind("magnetometer.correlated_noise_time_s", &options->correlated_noise_time_s,
                 "for which they last", Settings::Sign::Positive);
  settings->bind("magnetometer.correlated_noise_memory_s", &options->correlated_noise_memory_s,
                 "over which size and dip of the field teach it", Settings::Sign::Positive);
  settings->bind("magnetometer.student_dof", &options->student_dof,
                 "degrees of freedom of the distribution of these errors");
  settings->bind("magnetometer.noise_inflation", &options->noise_inflation,
                 "factor on the noise density of its calibration");
  settings->bind("magnetometer.offset_sigma_T", &options->offset_sigma_T,
                 "of hard iron that comes between calibration and dive");
  settings->bind("magnetometer.unstated_offset_sigma_T", &options->unstated_offset_sigma_T,
                 "of what a calibration leaves that does not say how sure it is");
  settings->bind("magnetometer.uncalibrated_offset_sigma_T", &options->uncalibrated_offset_sigma_T,
                 "of one that was never calibrated");
  settings->bind("magnetometer.uncalibrated_axes_sigma", &options->uncalibrated_axes_sigma,
                 "of such a one, relative: what soft iron and turned axes make of the field, in what heading "
                 "claims");
  settings->bind("magnetometer.offset_walk_T_per_sqrt_s", &options->offset_walk_T_per_sqrt_s,
                 "random walk of that offset, to start with");
  settings->bind("magnetometer.disturbance_sigma_T", &options->disturbance_sigma_T,
                 "of a disturbance that has come to stay");
  settings->bind("magnetometer.disturbance_walk_T_per_sqrt_s", &options->disturbance_walk_T_per_sqrt_s,
                 "random walk of such a disturbance");
  settings->bind("magnetometer.step.enabled", &options->step.enabled,
                 "correct readings by the field of currents on board that are switched");
  settings->bind("magnetometer.step.min_step_T", &options->step.min_step_T,
                 "smallest change that is taken for one");
}

void bindMagnetometerGate(Settings* settings, MagnetometerGateOptions* gate) {
  settings->bind("magnetometer.gate.max_norm_error", &gate->max_norm_error,
                 "of the field, relative to the estimated one");
  settings->bind("magnetometer.gate.max_dip_error_rad", &gate->max_dip_error_rad,
                 "against the estimated one");
  settings->bind("magnetometer.gate.max_sigmas", &gate->max_sigmas, "of the innovation");
  settings->bind("magnetometer.gate.field_sigma_T", &gate->field_sigma_T,
                 "of an undisturbed field, per axis");
  settings->bind("magnetometer.gate.release_share", &gate->release_share,
                 "of the limits, that a rejected field has to keep to be believed again");
  settings->bind("magnetometer.gate.release_s", &gate->release_s, "for so long");
  settings->bind("magnetometer.gate.memory_s", &gate->memory_s,
                 "over which rejections lower the weight of what is used", Settings::Sign::Positive);
  settings->bind("magnetometer.gate.rejection_window_s", &gate->rejection_window_s,
                 "over which agreement and rejection are weighed against each other");
  settings->bind("magnetometer.gate.max_rejected_ratio", &gate->max_rejected_ratio,
                 "of the times of rejection and agreement, beyond which nothing is believed any more");
  settings->bind("magnetometer.gate.rejection_margin_s", &gate->rejection_margin_s,
                 "by which that has to be exceeded, and agreement to prevail before it is believed again");
  settings->bind("magnetometer.gate.max_correlated_sigma_rad", &gate->max_correlated_sigma_rad,
                 "that the field's lasting error may be worth of heading");
  settings->bind("magnetometer.gate.retry_after_s", &gate->retry_after_s, "after which that is tried again");
  settings->bind("magnetometer.gate.readmission_s", &gate->readmission_s,
                 "after which a rejected field counts as a new one");
}

void bindDepth(Settings* settings, DepthOptions* options) {
  settings->bind("pressure.use", &options->use, "whether the pressure sensor is fused");
  settings->bind(
      "pressure.density_ratio", &options->density_ratio,
      "density of the water over that which the gauge assumes: 0.975 for a gauge set to salt water "
      "in fresh water");
  settings->bind("pressure.density_ratio_sigma", &options->density_ratio_sigma, "of that ratio; 0 holds it");
  settings->bind("pressure.water_density_prior", &options->water_density_prior,
                 "whether that ratio is rather that of fresh or salt water to a gauge set to either");
  settings->bind("pressure.least_density_sigma", &options->least_density_sigma,
                 "what images tell of that ratio is never taken for better than this in what heights claim");
  settings->bind("pressure.lag_s", &options->lag_s, "time constant of the gauge's answer");
  settings->bind("pressure.lag_sigma_s", &options->lag_sigma_s, "of that lag; 0 holds it");
  settings->bind("pressure.offset_walk_m_per_sqrt_s", &options->offset_walk_m_per_sqrt_s,
                 "random walk of the surface's pressure and level");
  settings->bind("pressure.noise_inflation", &options->noise_inflation,
                 "factor on the depth_noise_std of its file");
  settings->bind("pressure.floor_m", &options->floor_m, "lasting errors of the readings, one sigma");
  settings->bind("pressure.correlated_noise_time_s", &options->correlated_noise_time_s, "for which they last",
                 Settings::Sign::Positive);
  settings->bind("pressure.gate.max_sigmas", &options->gate.max_sigmas, "of a jump that is believed");
  settings->bind("pressure.gate.max_jump_m", &options->gate.max_jump_m, "that is believed in any case");
  settings->bind("pressure.gate.readmission_s", &options->gate.readmission_s,
                 "after which rejected readings, if steady, count from a new offset");
}

void bindSonar(Settings* settings, SonarOptions* options) {
  settings->bind("sonar.use", &options->use, "whether sonar ranges are used");
  settings->bind("sonar.noise_inflation", &options->noise_inflation,
                 "factor on the range_noise_std of its file", Settings::Sign::Positive);
  settings->bind("sonar.surface_angle_rad", &options->surface_angle_rad,
                 "landmarks within this angle of the beam form the surface that it meets",
                 Settings::Sign::Positive);
  settings->bind("sonar.min_landmarks", &options->min_landmarks, "that form a surface", 4);
  settings->bind("sonar.roughness", &options->roughness,
                 "of walls beside the scatter of the landmarks, relative to the range");
  settings->bind("sonar.correlated_noise_time_s", &options->correlated_noise_time_s,
                 "for which errors of the surface last", Settings::Sign::Positive);
  settings->bind("sonar.gate.max_sigmas", &options->max_sigmas, "of the innovation",
                 Settings::Sign::Positive);
}

}  // namespace

void bindRunSettings(Settings* settings, RunSettings* options) {
  bindSource(settings, &options->source, &options->synchronizer);
  bindFrontEnd(settings, &options->odometry.front_end, &options->odometry.max_tracks);
  bindInertial(settings, &options->odometry.estimator.preintegration, &options->odometry.estimator.imu_axes);
  bindStart(settings, &options->odometry.estimator.initial_state,
            &options->odometry.estimator.mono_initialization);
  bindEstimator(settings, &options->odometry.estimator);
  settings->bind("magnetometer.calibration", &options->magnetometer_calibration,
                 "file that `lodeline calibrate magnetometer` wrote; empty for none");
  bindMagnetometer(settings, &options->odometry.estimator.magnetometer);
  bindMagnetometerGate(settings, &options->odometry.estimator.magnetometer.gate);
  bindDepth(settings, &options->odometry.estimator.depth);
  bindSonar(settings, &options->odometry.estimator.sonar);
  settings->bind("heading.reference", &options->odometry.estimator.magnetometer.heading_reference,
                 {{"automatic", HeadingReference::Automatic},
                  {"true", HeadingReference::True},
                  {"magnetic", HeadingReference::Magnetic},
                  {"start", HeadingReference::Start}},
                 "where the world's y axis points; automatic: true north with site and date, else magnetic");
  settings->bind("heading.site", &options->site, "latitude_deg, longitude_deg, height_m; [] where unknown");
  settings->bind("heading.date", &options->date, "of the recording, YYYY-MM-DD; empty where unknown");
}

std::optional<Vec3> siteField_W(const RunSettings& options) {
  if (options.site.empty() && options.date.empty()) return std::nullopt;
  if (options.site.empty() || options.date.empty()) {
    throw UsageError("true north takes both place and date: --site LAT,LON,HEIGHT --date YYYY-MM-DD");
  }
  if (options.site.size() != 3) {
    throw UsageError(fmt::format("a site is latitude_deg,longitude_deg,height_m; here are {} numbers",
                                 options.site.size()));
  }
  const GeodeticPosition site{options.site[0], options.site[1], options.site[2]};
  return worldMagneticField(site, decimalYear(options.date)).field_ENU;
}

}  // namespace lodeline
