#include "lodeline/estimator/estimator.h"

#include <fmt/core.h>

#include "lodeline/estimator/keyframe_policy.h"
#include "lodeline/estimator/landmarks.h"
#include "lodeline/estimator/window_solver.h"

namespace lodeline {

const char* toString(Status status) {
  switch (status) {
    case Status::Waiting:
      return "waiting";
    case Status::Tracking:
      return "tracking";
    case Status::Inertial:
      return "inertial";
  }
  return "unknown";
}

Estimator::Estimator(const Rig& rig, const EstimatorOptions& options, Diagnostics* diagnostics)
    : rig_(rig),
      options_(options),
      diagnostics_(diagnostics),
      factors_(rig, options),
      marginalizer_(factors_) {
  for (const CameraCalibration& camera : rig.cameras) cameras_.push_back(makeCamera(camera));
}

FrameEstimate Estimator::add(const FrameTracks& tracks, std::span<const ImuSample> imu) {
  FrameEstimate estimate;
  estimate.time = tracks.time;
  if (!initialized()) {
    if (!initialize(tracks, imu, &estimate)) return estimate;
  } else {
    insertFrame(tracks, imu);
    addSightings(tracks);
    optimize(&estimate);
  }
  report(tracks, &estimate);
  if (wantsKeyframe(window_, factors_, options_.keyframe)) window_.newest().is_keyframe = true;
  estimate.is_keyframe = window_.newest().is_keyframe;
  createLandmarks(window_, factors_, options_.landmark);
  const bool starting_up = frames_added_ < options_.window.startup_frames;
  if (!starting_up) {
    marginalizer_.shorten(window_, options_.window.recent_frames, options_.window.keyframes);
  }
  return estimate;
}

bool Estimator::initialize(const FrameTracks& tracks, std::span<const ImuSample> imu,
                           FrameEstimate* estimate) {
  imu_before_start_.insert(imu_before_start_.end(), imu.begin() + (imu_before_start_.empty() ? 0 : 1),
                           imu.end());
  const Duration longest = Duration::fromSeconds(options_.initial_state.alignment_window_s);
  std::erase_if(imu_before_start_, [&](const ImuSample& s) { return s.time < tracks.time - longest; });
  int stereo_tracks = 0;
  for (const Observation& observation : tracks.observations) stereo_tracks += observation.camera > 0;
  if (stereo_tracks < options_.initial_state.min_stereo_tracks) {
    estimate->waiting_for =
        fmt::format("stereo matches {} of {}", stereo_tracks, options_.initial_state.min_stereo_tracks);
    return false;
  }
  if (imu_before_start_.size() < 2) {
    estimate->waiting_for = "inertial readings";
    return false;
  }
  const GravityAlignment up = alignWithGravity(imu_before_start_, Vec3::Zero(), options_.gravity_alignment);
  NavigationState state;
  state.time = tracks.time;
  state.world_from_body.rotation = up.world_from_body;
  state.gyroscope_bias_B = up.gyroscope_bias_B;
  auto frame = std::make_unique<Frame>();
  frame->id = frames_added_++;
  frame->setState(state);
  Frame& first = window_.add(std::move(frame));
  addSightings(tracks);

  const InitialStateOptions& prior = options_.initial_state;
  const double tilt_sigma = std::max(up.tilt_sigma_rad, prior.tilt_sigma_min_rad);
  Eigen::Matrix<double, 15, 1> sigmas;
  sigmas << Vec3::Constant(prior.position_sigma_m), tilt_sigma, tilt_sigma, prior.yaw_sigma_rad,
      Vec3::Constant(up.still ? prior.velocity_sigma_still_m_per_s : prior.velocity_sigma_m_per_s),
      Vec3::Constant(prior.gyroscope_bias_sigma_rad_per_s),
      Vec3::Constant(prior.accelerometer_bias_sigma_m_per_s2);
  marginalizer_.start(first, sigmas);
  return true;
}

void Estimator::insertFrame(const FrameTracks& tracks, std::span<const ImuSample> imu) {
  const NavigationState before = window_.newest().state();
  auto frame = std::make_unique<Frame>();
  frame->id = frames_added_++;
  frame->from_previous = std::make_unique<Preintegration>(
      imu, before.gyroscope_bias_B, before.accelerometer_bias_B, rig_.imu, options_.preintegration);
  frame->setState(predict(before, *frame->from_previous, options_.gravity_W));
  frame->time = tracks.time;
  window_.add(std::move(frame));
}

void Estimator::addSightings(const FrameTracks& tracks) {
  for (const Observation& observation : tracks.observations) {
    Sighting sighting;
    sighting.frame = window_.newest().id;
    sighting.camera = observation.camera;
    sighting.measurement = DirectionMeasurement::fromBearing(*cameras_[observation.camera],
                                                             observation.bearing_C, observation.sigma_px);
    window_.addSighting(observation.track, sighting);
  }
}

void Estimator::optimize(FrameEstimate* estimate) {
  const bool starting_up = frames_added_ < options_.window.startup_frames;
  const int max_iterations =
      starting_up ? options_.solver.max_iterations_startup : options_.solver.max_iterations;
  const SolveSummary summary = solveWindow(window_, marginalizer_.prior(), factors_, max_iterations);
  estimate->solver_iterations = summary.iterations;
  if (!summary.usable) {
    diagnostics_->report(
        Severity::Serious, "solver_failed",
        fmt::format("the window's optimisation failed at {} ns; the frame keeps its inertial "
                    "prediction",
                    estimate->time.nanoseconds()));
  }
  removeOutliers(window_, factors_, options_.landmark);
}

void Estimator::report(const FrameTracks& tracks, FrameEstimate* estimate) {
  const Frame& newest = window_.newest();
  const ReprojectionStatistics statistics = reprojectionStatistics(window_, factors_, newest.id);
  estimate->state = newest.state();
  estimate->covariance = newestCovariance(window_, marginalizer_.prior(), factors_);
  estimate->landmarks = statistics.landmarks;
  estimate->reprojection_rms_sigmas = statistics.rms_sigmas;
  for (const Observation& observation : tracks.observations) estimate->tracks += observation.camera == 0;
  const bool first = window_.frames().size() == 1;
  estimate->status = first || statistics.landmarks >= options_.min_landmarks_for_vision ? Status::Tracking
                                                                                        : Status::Inertial;
}

}  // namespace lodeline
