#include "lodeline/problem/state/window.h"

#include <algorithm>

namespace lodeline {

NavigationState Frame::state() const {
  NavigationState state;
  state.time = time;
  state.world_from_body = worldFromBody();
  state.velocity_W = velocity_W();
  state.gyroscope_bias_B = gyroscopeBias();
  state.accelerometer_bias_B = accelerometerBias();
  return state;
}

void Frame::setState(const NavigationState& state) {
  time = state.time;
  poseToBlock(state.world_from_body, pose.data());
  Eigen::Map<Eigen::Matrix<double, kMotionSize, 1>> block(motion.data());
  block << state.velocity_W, state.gyroscope_bias_B, state.accelerometer_bias_B;
}

void Frame::updateImageMotion() {
  if (!has_motion) return;
  const Vec3 velocity_B = worldFromBody().rotation.conjugate() * velocity_W();
  image_motion = {velocity_W(), gyroscope_B - gyroscopeBias(), velocity_B};
}

std::span<const Observation> FeatureTrack::in(FrameId frame) const {
  const auto before = [](const Observation& observation, FrameId id) { return observation.frame < id; };
  const auto begin = std::lower_bound(observations.begin(), observations.end(), frame, before);
  return {begin,
          std::find_if(begin, observations.end(), [&](const Observation& s) { return s.frame != frame; })};
}

const Observation* FeatureTrack::find(FrameId frame, int camera) const {
  for (const Observation& observation : in(frame)) {
    if (observation.camera == camera) return &observation;
  }
  return nullptr;
}

int FeatureTrack::frameCount() const {
  int count = 0;
  for (size_t i = 0; i < observations.size(); ++i)
    count += i == 0 || observations[i].frame != observations[i - 1].frame;
  return count;
}

void removeShortTracks(Tracks& tracks, size_t least_observations) {
  const auto is_short = [&](const auto& entry) {
    return entry.second.observations.size() < least_observations;
  };
  tracks.erase(std::remove_if(tracks.begin(), tracks.end(), is_short), tracks.end());
}

Frame& Window::add(std::unique_ptr<Frame> frame) {
  frames_.push_back(std::move(frame));
  return *frames_.back();
}

void Window::addObservation(TrackId track, const Observation& observation) {
  tracks_[track].observations.push_back(observation);
}

Frame* Window::find(FrameId id) const {
  const auto found = std::lower_bound(frames_.begin(), frames_.end(), id,
                                      [](const auto& frame, FrameId wanted) { return frame->id < wanted; });
  return found != frames_.end() && (*found)->id == id ? found->get() : nullptr;
}

Frame* Window::newestKeyframe() const {
  for (auto frame = frames_.rbegin(); frame != frames_.rend(); ++frame) {
    if ((*frame)->is_keyframe) return frame->get();
  }
  return nullptr;
}

int Window::recentCount() const {
  return static_cast<int>(
      std::count_if(frames_.begin(), frames_.end(), [](const auto& frame) { return frame->has_motion; }));
}

int Window::poseOnlyCount() const {
  return static_cast<int>(std::count_if(frames_.begin(), frames_.end(), [](const auto& frame) {
    return !frame->has_motion && !frame->interpolated;
  }));
}

Frame* Window::oldestRecent() const {
  const auto found =
      std::find_if(frames_.begin(), frames_.end(), [](const auto& frame) { return frame->has_motion; });
  return found == frames_.end() ? nullptr : found->get();
}

Frame* Window::after(const Frame& frame) const {
  const auto found = std::upper_bound(frames_.begin(), frames_.end(), frame.id,
                                      [](FrameId id, const auto& other) { return id < other->id; });
  return found == frames_.end() ? nullptr : found->get();
}

ParameterBlock& Window::add(ParameterBlock state) {
  return *globals_.emplace_back(std::make_unique<ParameterBlock>(std::move(state)));
}

ParameterBlock* Window::findGlobal(std::string_view name) const {
  const auto found = std::find_if(globals_.begin(), globals_.end(),
                                  [name](const auto& state) { return state->name == name; });
  return found == globals_.end() ? nullptr : found->get();
}

void Window::interpolate(Frame& frame, const Frame& before, const Frame& after) {
  const double share = (frame.time - before.time).seconds() / (after.time - before.time).seconds();
  frame.interpolated = {
      before.id, after.id,
      PoseInterpolation(before.worldFromBody(), frame.worldFromBody(), after.worldFromBody(), share)};
  frame.has_motion = false;
  frame.first_motion.reset();
  placeInterpolated();
}

void Window::placeInterpolated() {
  for (const auto& frame : frames_) {
    if (!frame->interpolated) continue;
    const auto& [before_id, after_id, between] = *frame->interpolated;
    const Frame &before = *find(before_id), &after = *find(after_id);
    poseToBlock(between.pose(before.worldFromBody(), after.worldFromBody()), frame->pose.data());
    frame->first_pose.emplace();
    poseToBlock(between.pose(before.firstWorldFromBody(), after.firstWorldFromBody()),
                frame->first_pose->data());
  }
}

void Window::remove(FrameId id) {
  std::vector<FrameId> gone(1, id);
  for (const auto& frame : frames_) {
    if (frame->interpolated && (frame->interpolated->before == id || frame->interpolated->after == id))
      gone.push_back(frame->id);
  }
  const auto goes = [&](FrameId frame) { return std::find(gone.begin(), gone.end(), frame) != gone.end(); };
  for (auto& [track_id, track] : tracks_)
    std::erase_if(track.observations,
                  [&](const Observation& observation) { return goes(observation.frame); });
  removeEmptyTracks();
  std::erase_if(frames_, [&](const auto& frame) { return goes(frame->id); });
}

void Window::removeEmptyTracks() { removeShortTracks(tracks_, 1); }

}  // namespace lodeline
