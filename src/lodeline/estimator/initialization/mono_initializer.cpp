#include "lodeline/estimator/initialization/mono_initializer.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "lodeline/cameras/camera_model.h"
#include "lodeline/estimator/initialization/start.h"
#include "lodeline/estimator/initialization/visual_inertial_alignment.h"
#include "lodeline/estimator/initialization/visual_structure.h"
#include "lodeline/estimator/solver/window_solver.h"
#include "lodeline/estimator/visual/landmarks.h"
#include "lodeline/imu/gravity_alignment.h"
#include "lodeline/problem/covariance.h"

namespace lodeline {
namespace {

/// Mean square of the whitened inertial residuals of a window: about one or less where the solution is
/// correct.
double inertialDisagreement(Window& window, const FactorBuilder& factors) {
  double square_sum = 0.0;
  std::vector<double> residual;
  Frame* before = nullptr;
  for (const auto& frame : window.frames()) {
    if (before) square_sum += 2.0 * costOf(factors.inertial(window, *before, *frame), residual);
    before = frame.get();
  }
  return square_sum / static_cast<double>((window.frames().size() - 1) * inertial_error::kSize);
}

}  // namespace

bool MonoInitializer::add(Time time, const ObservationList& observations, std::span<const ImuSample> imu,
                          FrameId id, const Rest& rest, const Sensors& sensors) {
  pending_imu_.insert(pending_imu_.end(), imu.begin() + (pending_imu_.empty() || imu.empty() ? 0 : 1),
                      imu.end());
  pending_rest_ = pending_rest_ || rest.now;
  gyroscope_ = rest.gyroscope;
  const MonoInitializationOptions& wanted = options_.mono_initialization;
  if (!window_.empty() && (time - window_.newest().time).seconds() < wanted.min_frame_distance_s)
    return false;
  if (pending_imu_.size() < 2 && !window_.empty()) {
    waiting_for_ = "inertial readings";
    return false;
  }
  insert(time, observations, id, sensors);
  while ((time - window_.frames().front()->time).seconds() > wanted.max_duration_s ||
         (window_.frames().size() > 1 &&
          commonTracks(window_, *window_.frames().front(), window_.newest()).size() <
              static_cast<size_t>(wanted.min_common_tracks))) {
    dropOldestFrame();
  }
  const int frames = static_cast<int>(window_.frames().size());
  if (frames < wanted.min_frames) {
    waiting_for_ = fmt::format("frames {} of {} that share {} tracks", frames, wanted.min_frames,
                               wanted.min_common_tracks);
    return false;
  }
  if (refused_ && (time - *refused_).seconds() < wanted.retry_after_s) return false;
  if (!solveVisualStructure() || !alignWithInertial()) return false;
  if (refine(sensors)) return true;
  refused_ = time;
  return false;
}

void MonoInitializer::insert(Time time, const ObservationList& observations, FrameId id,
                             const Sensors& sensors) {
  auto frame = std::make_unique<Frame>();
  frame->id = id;
  frame->time = time;
  frame->is_keyframe = true;
  if (!window_.empty()) {
    intervals_[id] = std::make_unique<Preintegration>(pending_imu_, Vec3::Zero(), Vec3::Zero(), rig_.imu,
                                                      options_.preintegration);
  }
  if (!pending_imu_.empty()) frame->gyroscope_B = pending_imu_.back().angular_velocity_B;
  pending_imu_.clear();
  if (pending_rest_) frame->rest_sigma_m_per_s = options_.rest.velocity_sigma_m_per_s;
  pending_rest_ = false;
  window_.add(std::move(frame));
  for (const auto& [track, observation] : observations) window_.addObservation(track, observation);
  for (const auto& sensor : sensors) {
    if (auto measurement = sensor->measureBeforeStart(time)) measurements_[id].add(std::move(measurement));
  }
}

void MonoInitializer::dropOldestFrame() {
  measurements_.erase(window_.frames().front()->id);
  window_.remove(window_.frames().front()->id);
  // The interval before the frame that is now the oldest.
  if (!window_.empty()) intervals_.erase(window_.frames().front()->id);
}

std::vector<Preintegration*> MonoInitializer::intervals() const {
  std::vector<Preintegration*> result;
  for (const auto& [id, interval] : intervals_) result.push_back(interval.get());
  return result;
}

bool MonoInitializer::solveVisualStructure() {
  for (auto& [id, track] : window_.tracks()) track.landmark.reset();
  const double focal_px = focalLengthOnAxis_px(rig_.cameras[0]);
  const double parallax_px = focal_px * parallaxAfterBestRotation(commonTracks(
                                            window_, *window_.frames().front(), window_.newest()));
  if (parallax_px < options_.mono_initialization.min_parallax_px) {
    waiting_for_ = fmt::format("parallax {:.0f} of {:.0f} px", parallax_px,
                               options_.mono_initialization.min_parallax_px);
    return false;
  }
  if (!estimateStructure(window_, intervals(), factors_, focal_px, options_.mono_initialization)) {
    waiting_for_ = "a rigid structure that explains the images";
    return false;
  }
  return true;
}

Vec3 MonoInitializer::gyroscopeBias(const std::vector<Quat>& rotations) {
  constexpr double kContradiction_rad_per_s = 0.01;
  const Vec3 aligned = alignGyroscopeBias(rotations, intervals());
  // The rig may have rested on a turning base with nothing else in view.
  if (gyroscope_ && (gyroscope_->bias_B - aligned).norm() > kContradiction_rad_per_s) gyroscope_.reset();
  if (!gyroscope_) return aligned;
  for (Preintegration* interval : intervals())
    interval->repropagate(gyroscope_->bias_B, interval->accelerometerBias());
  return gyroscope_->bias_B;
}

MeasuredVelocities MonoInitializer::measuredVelocities() const {
  MeasuredVelocities velocities(window_.frames().size());
  for (size_t k = 0; k < velocities.size(); ++k) {
    const auto measured = measurements_.find(window_.frames()[k]->id);
    if (measured == measurements_.end()) continue;
    for (const auto& measurement : measured->second)
      if (auto velocity = measurement->velocity()) velocities[k] = velocity;
  }
  return velocities;
}

bool MonoInitializer::alignWithInertial() {
  const Rigid3& body_from_camera = factors_.bodyFromCamera(0);
  std::vector<Quat> rotations;
  std::vector<Vec3> camera_positions;
  for (const auto& frame : window_.frames()) {
    rotations.push_back(frame->worldFromBody().rotation);
    camera_positions.push_back(frame->worldFromBody() * body_from_camera.translation);
  }
  const Vec3 gyroscope_bias = this->gyroscopeBias(rotations);
  const double gravity = options_.gravity_W.norm();
  const std::optional<VisualInertialAlignment> alignment =
      alignVisualInertial(rotations, camera_positions, body_from_camera.translation, intervals(), gravity,
                          options_.initial_state.accelerometer_bias_sigma_m_per_s2, measuredVelocities());
  const double tolerance = options_.mono_initialization.gravity_tolerance_m_per_s2;
  if (!alignment || std::abs(alignment->free_gravity_magnitude - gravity) > tolerance) {
    waiting_for_ = "enough acceleration to tell the scale";
    return false;
  }
  const Vec3 up_B0 = rotations.front().conjugate() * -alignment->gravity_V;
  const Quat world_from_visual = levelWithZeroYaw(up_B0) * rotations.front().conjugate();
  const Vec3 origin_V =
      alignment->scale * camera_positions.front() - rotations.front() * body_from_camera.translation;
  size_t k = 0;
  for (const auto& frame : window_.frames()) {
    NavigationState state;
    state.time = frame->time;
    const Vec3 body_V = alignment->scale * camera_positions[k] - rotations[k] * body_from_camera.translation;
    state.world_from_body = Rigid3(world_from_visual * rotations[k], world_from_visual * (body_V - origin_V));
    state.velocity_W = world_from_visual * alignment->velocities_V[k];
    state.gyroscope_bias_B = gyroscope_bias;
    state.accelerometer_bias_B = alignment->accelerometer_bias_B;
    frame->setState(state);
    ++k;
  }
  for (auto& [id, track] : window_.tracks()) {
    if (track.landmark) track.landmark->parameters[2] /= alignment->scale;
  }
  return true;
}

void MonoInitializer::giveToFrames() {
  for (const auto& frame : window_.frames()) {
    const auto interval = intervals_.find(frame->id);
    if (interval != intervals_.end()) frame->from_previous = std::move(interval->second);
    const auto measured = measurements_.find(frame->id);
    if (measured != measurements_.end()) frame->measurements = std::move(measured->second);
  }
}

void MonoInitializer::takeFromFrames() {
  for (const auto& frame : window_.frames()) {
    if (frame->from_previous) intervals_[frame->id] = std::move(frame->from_previous);
    if (!frame->measurements.empty()) measurements_[frame->id] = std::exchange(frame->measurements, {});
  }
}

bool MonoInitializer::refine(const Sensors& sensors) {
  InitialStateOptions known = options_.initial_state;
  if (gyroscope_) known.gyroscope_bias_sigma_rad_per_s = gyroscope_->sigma_rad_per_s;
  prior_ = startPrior(*window_.frames().front(), known, options_.mono_initialization.start_tilt_sigma_rad);
  if (!measurements_.empty()) {
    for (const auto& sensor : sensors) sensor->addStatesBeforeStart(window_, prior_);
  }
  giveToFrames();
  const SolveSummary summary =
      solveWithCeres(window_, prior_, factors_, {options_.mono_initialization.max_iterations, 1e-8});
  if (isGood(summary.usable && summary.converged)) {
    intervals_.clear();
    measurements_.clear();
    return true;
  }
  takeFromFrames();
  return false;
}

bool MonoInitializer::isGood(bool is_solved) {
  const double disagreement = inertialDisagreement(window_, factors_);
  const double share = scaleUncertainty(window_.newest(), newestCovariance(window_, prior_, factors_));
  const double bias_sigmas =
      window_.newest().accelerometerBias().norm() / options_.initial_state.accelerometer_bias_sigma_m_per_s2;
  if (!is_solved || disagreement > options_.mono_initialization.max_inertial_disagreement ||
      bias_sigmas > options_.mono_initialization.max_bias_sigmas) {
    waiting_for_ = "a start on which images and inertial readings agree";
    return false;
  }
  if (share > options_.mono_initialization.max_scale_sigma) {
    waiting_for_ = fmt::format("scale known to {:.0f} % of {:.0f} %", 100.0 * share,
                               100.0 * options_.mono_initialization.max_scale_sigma);
    return false;
  }
  return true;
}

}  // namespace lodeline
