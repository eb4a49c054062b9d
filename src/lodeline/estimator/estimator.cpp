#include "lodeline/estimator/estimator.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "lodeline/diagnostics.h"
#include "lodeline/estimator/initialization/start.h"
#include "lodeline/estimator/monitoring/inertial_monitor.h"
#include "lodeline/estimator/sensor_registry.h"
#include "lodeline/estimator/solver/window_update.h"
#include "lodeline/estimator/uncertainty/reported_covariance.h"
#include "lodeline/estimator/visual/landmarks.h"
#include "lodeline/problem/covariance.h"
#include "lodeline/problem/marginalization/keyframe_policy.h"
#include "lodeline/problem/marginalization/landmark_host.h"
#include "lodeline/problem/robust_loss.h"
#include "lodeline/problem/state/camera_states.h"
#include "lodeline/problem/state/inertial_states.h"

namespace lodeline {

namespace {

/// A bias that no accelerometer has: a start of one camera that was a false minimum, or readings that are not
/// what the calibration says. What follows is wrong, however small the reprojection errors.
void reportImplausibleBias(const FrameEstimate& estimate, const EstimatorOptions& options,
                           Diagnostics* diagnostics) {
  const double limit_m_per_s2 =
      options.mono_initialization.max_bias_sigmas * options.initial_state.accelerometer_bias_sigma_m_per_s2;
  const double bias_m_per_s2 = estimate.state.accelerometer_bias_B.norm();
  if (bias_m_per_s2 <= limit_m_per_s2) return;
  diagnostics->report(
      Severity::Serious, "accelerometer_bias",
      fmt::format(
          "at {} ns the accelerometer's bias is estimated at {:.2f} m/s^2, more than {:.2f}: a false start, "
          "or an "
          "accelerometer whose unit, range or axes are not as the calibration says; positions are not to "
          "be trusted where this is found. Start with more motion and clearer images, or check the "
          "calibration",
          estimate.time.nanoseconds(), bias_m_per_s2, limit_m_per_s2));
}

/// A frame without a covariance is not to look as if it were known exactly.
void requireCovariance(FrameEstimate* estimate, Diagnostics* diagnostics) {
  if (isCovariance(estimate->covariance)) return;
  estimate->covariance = kUnknownVariance * Eigen::Matrix<double, 15, 15>::Identity();
  diagnostics->report(
      Severity::Serious, "covariance_unknown",
      fmt::format(
          "at {} ns the covariance is unknown: some measurements are stated so precisely, or contradict "
          "each other so much, that rounding hides what the others say. Sigmas of {:.0e} stand for "
          "it. Are the noise densities of the calibration those of a real sensor?",
          estimate->time.nanoseconds(), std::sqrt(kUnknownVariance)));
}

/// The newest keyframe's landmarks then drop what the oldest saw of them, however long the window still is.
WindowOptions withoutCut(WindowOptions window) {
  window.split_at_keyframe = std::numeric_limits<int>::max();
  return window;
}

}  // namespace

Estimator::Estimator(const Rig& rig, const EstimatorOptions& options, Diagnostics* diagnostics)
    : rig_(rig),
      options_(optionsFor(rig, options)),
      diagnostics_(diagnostics),
      factors_(rig_, options_),
      marginalizer_(factors_),
      mono_initializer_(rig_, options_, factors_),
      sensors_(makeSensorFusions(rig_, options_, diagnostics)),
      intrinsics_model_selection_(options_.camera_calibration),
      scale_(rig_, options_),
      linearization_cache_(options_.window.frozen_frames),
      rest_(rig_, options_.rest),
      monitor_(std::make_unique<InertialMonitor>(rig_, options_, diagnostics)),
      known_(Eigen::Matrix<double, 15, 15>::Identity()),
      covariance_inflation_(options_),
      mode_(options_.window) {
  for (const CameraCalibration& camera : rig.cameras) cameras_.push_back(makeCamera(camera));
}

Estimator::~Estimator() = default;

bool Estimator::isGyroscopeDoubted() const { return monitor_->isGyroscopeDoubted(); }

FrameEstimate Estimator::add(const FrameTracks& tracks, std::span<const ImuSample> imu,
                             const SensorReadings& readings) {
  FrameEstimate estimate;
  estimate.time = tracks.time;
  checkOrder(tracks.time, imu);
  const ObservationList observations = observationsOf(tracks);
  const bool carries_on = initialized();
  const Vec3 gyroscope_bias_B = carries_on ? window_.newest().gyroscopeBias() : Vec3::Zero();
  for (const auto& sensor : sensors_) sensor->take(readings, imu, gyroscope_bias_B);
  rests_ = rest_.add(tracks, imu);
  monitor_->take(imu);
  if (carries_on) insertFrame(tracks.time, observations, imu);
  if (carries_on && rests_) window_.newest().rest_sigma_m_per_s = options_.rest.velocity_sigma_m_per_s;
  last_time_ = tracks.time;
  if (carries_on) {
    optimize(&estimate);
  } else if (initialize(tracks, observations, imu, &estimate)) {
    startSensors();
    rememberCovariance(jointCovariance(window_, marginalizer_.prior(), factors_), &estimate);
  } else {
    addSensorRows(&estimate);
    return estimate;
  }
  report(tracks, &estimate);
  addSensorRows(&estimate);
  inertial_covariance_propagation_.follow(window_, factors_, estimate.status == Status::Inertial && !rests_,
                                          estimate.sensors.of<MagnetometerEstimate>().field_W.has_value(),
                                          &estimate.covariance);
  requireCovariance(&estimate, diagnostics_);
  reportImplausibleBias(estimate, options_, diagnostics_);
  if (wantsKeyframe(window_, factors_, options_.keyframe)) window_.newest().is_keyframe = true;
  estimate.is_keyframe = window_.newest().is_keyframe;
  createLandmarks(window_, factors_, options_.landmark);
  mode_.addFrame();
  const bool has_velocity = window_.newest().measurements.measureVelocity();
  if (mode_.see(estimate.time, estimate.status != Status::Inertial, has_velocity))
    reinitializeAfterVisionLoss();
  // Not at the start: whoever records it needs the prior of the first frame as it was.
  if (carries_on) marginalizeWindow(estimate);
  if (mode_.isSettled() && mode_.isMarginalizing()) linearization_cache_.freeze(window_, factors_);
  estimate.mode = mode_.mode();
  covariance_inflation_.follow(estimate.state.world_from_body, estimate.scene_distance_m);
  MagnetometerEstimate& magnetometer = estimate.sensors.of<MagnetometerEstimate>();
  covariance_inflation_.addTo(
      {mode_.scaleIsGiven(), estimate.sensors.of<DepthEstimate>().unmodelledDensitySigma(),
       magnetometer.field_W.has_value(), !options_.imu_axes.areDoubted()},
      &estimate.covariance);
  monitor_->addTo(estimate.state.world_from_body.translation, &estimate.covariance);
  addHeadingError(magnetometer.axes_sigma_rad, estimate.state, &estimate.covariance);
  magnetometer.heading_sigma_rad =
      std::hypot(std::sqrt(estimate.covariance(5, 5)), magnetometer.declination_sigma_rad);
  return estimate;
}

void Estimator::addSensorRows(FrameEstimate* estimate) const {
  for (const auto& sensor : sensors_) {
    if (auto row = sensor->row()) estimate->sensor_rows.push_back(std::move(*row));
  }
}

std::vector<std::string> Estimator::sensorColumns() const {
  std::vector<std::string> names;
  for (const auto& sensor : sensors_) {
    const auto row = sensor->row();
    if (!row) continue;
    for (const auto& [name, value] : row->columns) names.push_back(name);
  }
  return names;
}

void Estimator::checkOrder(Time time, std::span<const ImuSample> imu) const {
  const int64_t now_ns = time.nanoseconds();
  if (last_time_ && time <= *last_time_) {
    throw InputError(fmt::format("frame at {} ns comes after one at {} ns; frames must come in order of time",
                                 now_ns, last_time_->nanoseconds()));
  }
  if (imu.empty()) {
    if (!initialized()) return;
    throw InputError(fmt::format("no inertial readings lead to the frame at {} ns; give those since {} ns",
                                 now_ns, last_time_->nanoseconds()));
  }
  if (imu.back().time != time || (initialized() && imu.front().time != *last_time_)) {
    throw InputError(
        fmt::format("inertial readings from {} to {} ns do not lead to the frame at {} ns; give them from "
                    "frame to frame, "
                    "interpolated at both ends",
                    imu.front().time.nanoseconds(), imu.back().time.nanoseconds(), now_ns));
  }
}

void Estimator::reinitializeAfterVisionLoss() {
  // The linearization points are those of inertial propagation, which images now correct by more than the rig
  // moves.
  marginalizer_.resetLinearizationPoints(window_);
  if (!mode_.scaleIsGiven()) resetRobustLosses(window_);
}

void Estimator::marginalizeWindow(const FrameEstimate& estimate) {
  // The distance from the origin carries no information on a scale that was lost since.
  mode_.judgeScale(estimate.time, mode_.scaleWasLost()
                                      ? speedUncertainty(window_.newest(), estimate.covariance)
                                      : scaleUncertainty(window_.newest(), estimate.covariance));
  // What is marginalized keeps the intrinsics that it has then.
  if (mode_.isSettled()) freeIntrinsics();
  if (!mode_.isMarginalizing()) return;
  if (mode_.hasChanged()) marginalizer_.resetLinearizationPoints(window_);
  if (estimate.status == Status::Inertial)
    keepLastView(window_, options_.window.recent_frames, options_.min_landmarks_for_vision);
  marginalizer_.marginalizeToSize(
      window_, mode_.isWorthKeeping(estimate.time) ? options_.window : withoutCut(options_.window));
  if (!mode_.isSettled()) marginalizer_.resetLinearizationPoints(window_);
}

void Estimator::freeIntrinsics() {
  if (!options_.camera_calibration.intrinsics || !cameraStates(window_).intrinsics.empty()) return;
  Prior prior = marginalizer_.prior();
  addIntrinsicsStates(window_, prior, static_cast<int>(rig_.cameras.size()), options_.camera_calibration);
  marginalizer_.start(std::move(prior));
}

ObservationList Estimator::observationsOf(const FrameTracks& tracks) const {
  ObservationList observations;
  for (const FeatureObservation& seen : tracks.observations) {
    Observation observation;
    observation.frame = next_frame_id_;
    observation.camera = seen.camera;
    observation.measurement =
        DirectionMeasurement::fromRay(*cameras_[seen.camera], {seen.origin_C, seen.bearing_C}, seen.sigma_px);
    observations.emplace_back(seen.track, observation);
  }
  return observations;
}

bool Estimator::initialize(const FrameTracks& tracks, const ObservationList& observations,
                           std::span<const ImuSample> imu, FrameEstimate* estimate) {
  camera_rotations_ = tracks.camera_rotations;
  imu_before_start_.insert(imu_before_start_.end(),
                           imu.begin() + (imu_before_start_.empty() || imu.empty() ? 0 : 1), imu.end());
  const Duration longest = Duration::fromSeconds(options_.initial_state.alignment_window_s);
  std::erase_if(imu_before_start_, [&](const ImuSample& s) { return s.time < tracks.time - longest; });
  const auto stereo_matches = std::count_if(observations.begin(), observations.end(),
                                            [](const auto& entry) { return entry.second.camera > 0; });
  if (stereo_matches >= options_.initial_state.min_stereo_tracks)
    return startAtOnce(tracks.time, observations, estimate);
  if (startMonocular(tracks.time, observations, imu)) return true;
  estimate->waiting_for = mono_initializer_.waitingFor();
  if (rig_.cameras.size() > 1) {
    estimate->waiting_for = fmt::format("stereo matches {} of {}, or {}", stereo_matches,
                                        options_.initial_state.min_stereo_tracks, estimate->waiting_for);
  }
  return false;
}

void Estimator::addCalibration(Prior* prior) {
  addCameraStates(window_, *prior, static_cast<int>(rig_.cameras.size()), options_.camera_calibration,
                  camera_rotations_);
  addShutterState(window_, *prior, rig_, options_.camera_calibration);
  addInertialStates(window_, options_.imu_axes);
}

bool Estimator::startMonocular(Time time, ObservationList observations, std::span<const ImuSample> imu) {
  std::erase_if(observations, [](const auto& entry) { return entry.second.camera > 0; });
  if (!mono_initializer_.add(time, observations, imu, next_frame_id_++, {rests_, rest_.gyroscope()},
                             sensors_))
    return false;
  window_ = mono_initializer_.takeWindow();
  Prior prior = mono_initializer_.takePrior();
  addCalibration(&prior);
  marginalizer_.start(std::move(prior));
  mode_.start(false, static_cast<int>(window_.frames().size()));
  return true;
}

bool Estimator::startAtOnce(Time time, const ObservationList& observations, FrameEstimate* estimate) {
  if (imu_before_start_.empty()) {
    estimate->waiting_for = "inertial readings";
    return false;
  }
  GravityAlignment up;
  try {
    up = alignWithGravity(imu_before_start_, Vec3::Zero(), options_.gravity_alignment);
  } catch (const EstimationError& error) {
    estimate->waiting_for = error.what();
    return false;
  }
  NavigationState state;
  state.time = time;
  state.world_from_body.rotation = up.world_from_body;
  state.gyroscope_bias_B = up.gyroscope_bias_B;
  auto frame = std::make_unique<Frame>();
  frame->id = next_frame_id_++;
  frame->setState(state);
  frame->gyroscope_B = imu_before_start_.back().angular_velocity_B;
  Frame& first = window_.add(std::move(frame));
  for (const auto& [track, observation] : observations) window_.addObservation(track, observation);
  Prior prior = startPrior(first, options_.initial_state, up.tilt_sigma_rad);
  tieTiltToAccelerometerBias(first, options_.gravity_W.norm(), &prior);
  addCalibration(&prior);
  marginalizer_.start(std::move(prior));
  mode_.start(true, 0);
  return true;
}

void Estimator::insertFrame(Time time, const ObservationList& observations, std::span<const ImuSample> imu) {
  const NavigationState before = window_.newest().state();
  auto frame = std::make_unique<Frame>();
  frame->id = next_frame_id_++;
  frame->from_previous = std::make_unique<Preintegration>(
      imu, before.gyroscope_bias_B, before.accelerometer_bias_B, rig_.imu, options_.preintegration);
  frame->setState(predict(before, *frame->from_previous, options_.gravity_W));
  frame->time = time;
  frame->gyroscope_B = imu.back().angular_velocity_B;
  window_.add(std::move(frame));
  for (const auto& [track, observation] : observations) window_.addObservation(track, observation);
  monitor_->check(window_, factors_, known_);
  for (const auto& sensor : sensors_) sensor->addToNewest(window_, marginalizer_);
}

void Estimator::startSensors() {
  Prior prior = marginalizer_.prior();
  const Eigen::Matrix<double, 15, 15> known = newestCovariance(window_, prior, factors_);
  const double tilt_sigma_rad = std::sqrt(0.5 * known.diagonal().segment<2>(3).sum());
  for (const auto& sensor : sensors_) sensor->start(tilt_sigma_rad, &window_, &prior);
  marginalizer_.start(std::move(prior));
}

void Estimator::rememberCovariance(const JointCovariance& covariance, FrameEstimate* estimate) {
  if (!mode_.isBlind() && !isCovariance(covariance.newest())) {
    diagnostics_->report(
        Severity::Serious, "covariance_unknown",
        fmt::format(
            "at {} ns the window's covariance is lost in rounding; that of the frame before is carried "
            "on by inertial readings. Are the noise densities of the calibration those of a real "
            "sensor?",
            estimate->time.nanoseconds()));
  }
  known_ = estimate->covariance = reportedCovariance(covariance, window_, options_, factors_);
  estimate->posterior_covariance = covariance.newest();
  intrinsics_model_selection_.remember(covariance, window_);
  for (const auto& sensor : sensors_) sensor->remember(covariance, window_);
  for (const auto& sensor : sensors_) {
    sensor->relate(window_, &estimate->covariance);
    sensor->relate(window_, &estimate->posterior_covariance);
  }
}

void Estimator::optimize(FrameEstimate* estimate) {
  linearization_cache_.invalidateIfStale(window_);
  WindowUpdate update = updateWindow(window_, marginalizer_.prior(), factors_,
                                     {options_.solver.max_iterations, options_.solver.function_tolerance},
                                     linearization_cache_);
  const SolveSummary summary = update.summary;
  rememberCovariance(update.covariance, estimate);
  estimate->solver_iterations = summary.iterations;
  if (!summary.usable) {
    diagnostics_->report(
        Severity::Serious, "solver_failed",
        fmt::format("the window's optimization failed at {} ns; the frame keeps its inertial "
                    "prediction",
                    estimate->time.nanoseconds()));
  }
  std::vector<ObservationError> errors;
  removeOutliers(window_, update.errors_sigmas, options_.landmark, &errors);
  errors.insert(errors.end(), linearization_cache_.errors().begin(), linearization_cache_.errors().end());
  // As long as the scale is unknown, small errors do not mean that the poses are right.
  if (mode_.isSettled() || mode_.scaleIsGiven()) adaptRobustLosses(window_, errors, options_.solver);
}

void Estimator::report(const FrameTracks& tracks, FrameEstimate* estimate) {
  const Frame& newest = window_.newest();
  const ReprojectionStatistics statistics = reprojectionStatistics(window_, factors_, newest.id);
  estimate->state = newest.state();
  estimate->camera_corrections = cameraCorrections(window_);
  estimate->gyroscope_axes = gyroscopeAxes(window_);
  estimate->accelerometer_axes = accelerometerAxes(window_);
  for (const auto& sensor : sensors_) sensor->report(window_, &estimate->sensors);
  const auto& gauge = estimate->sensors.of<DepthEstimate>().gauge;
  estimate->scale = scale_.add(window_, gauge ? gauge->told_sigma : options_.depth.density_ratio_sigma,
                               estimate->posterior_covariance.block<3, 3>(6, 6));
  estimate->landmarks = statistics.landmarks;
  estimate->scene_distance_m = meanLandmarkDistance_m(window_, newest.id, 0);
  estimate->reprojection_rms_sigmas = statistics.rms_sigmas;
  for (const FeatureObservation& observation : tracks.observations)
    estimate->tracks += observation.camera == 0;
  const bool first = window_.frames().size() == 1;
  const bool sees = first || statistics.landmarks >= options_.min_landmarks_for_vision;
  estimate->status = !sees ? Status::Inertial : monitor_->isAlarmed() ? Status::Degraded : Status::Tracking;
  if (newest.from_previous) estimate->inertial_doubt = newest.from_previous->doubt();
}

std::vector<MapPoint> Estimator::currentMapPoints() const {
  std::vector<MapPoint> points;
  for (const auto& [id, track] : window_.tracks()) {
    if (!track.landmark) continue;
    if (const auto point = mapPointOf(window_, id, track, factors_)) points.push_back(*point);
  }
  return points;
}

}  // namespace lodeline
