#include "lodeline/problem/marginalization/keyframe_policy.h"

#include <algorithm>
#include <cmath>

#include "lodeline/util/median.h"

namespace lodeline {

std::optional<double> medianParallax(const Window& window, const Frame& a, const Frame& b,
                                     const FactorBuilder& factors) {
  const Rigid3& body_from_camera = factors.bodyFromCamera(0);
  const Quat b_from_a = (b.worldFromBody().rotation * body_from_camera.rotation).conjugate() *
                        (a.worldFromBody().rotation * body_from_camera.rotation);
  std::vector<double> angles;
  for (const auto& [id, track] : window.tracks()) {
    const Observation* in_a = track.find(a.id, 0);
    const Observation* in_b = track.find(b.id, 0);
    if (!in_a || !in_b) continue;
    const Vec3 turned = b_from_a * in_a->measurement.bearing_C;
    angles.push_back(std::atan2(turned.cross(in_b->measurement.bearing_C).norm(),
                                turned.dot(in_b->measurement.bearing_C)));
  }
  if (angles.empty()) return std::nullopt;
  return median(std::move(angles));
}

std::optional<KeyframesAbout> keyframesAbout(const Window& window, const Frame& frame,
                                             const WindowOptions& options) {
  const Frame *before = nullptr, *after = nullptr, *last = nullptr;
  for (const auto& other : window.frames()) {
    if (other->id < frame.id) {
      last = other.get();
      if (other->is_keyframe) before = last;
    } else if (other->id > frame.id && other->is_keyframe) {
      after = other.get();
      break;
    }
  }
  if (!before || !after) return std::nullopt;
  const auto seconds = [](const Frame& a, const Frame& b) { return (b.time - a.time).seconds(); };
  if (seconds(*last, frame) < options.interpolated_spacing_s ||
      seconds(frame, *after) < options.interpolated_spacing_s ||
      seconds(*before, *after) > options.interpolated_gap_s) {
    return std::nullopt;
  }
  const bool sees = std::any_of(window.tracks().begin(), window.tracks().end(), [&](const auto& entry) {
    return entry.second.landmark && entry.second.seenIn(frame.id);
  });
  if (!sees) return std::nullopt;
  return KeyframesAbout{before, after};
}

bool wantsKeyframe(const Window& window, const FactorBuilder& factors, const KeyframeOptions& options) {
  const Frame* last = window.newestKeyframe();
  if (!last) return true;
  const Frame& newest = window.newest();
  int tracks_now = 0;
  int fresh_tracks = 0;
  int landmarks_now = 0;
  int landmarks_last = 0;
  for (const auto& [id, track] : window.tracks()) {
    const bool now = track.seenIn(newest.id);
    tracks_now += now;
    fresh_tracks += now && !track.seenIn(last->id);
    if (!track.landmark) continue;
    landmarks_now += now;
    landmarks_last += track.seenIn(last->id);
  }
  if (tracks_now == 0) return false;
  if ((newest.time - last->time).seconds() > options.min_interval_s) {
    const std::optional<double> parallax = medianParallax(window, *last, newest, factors);
    if (parallax && *parallax > options.min_parallax_rad) return true;
  }
  const bool sees_little =
      landmarks_now < options.min_landmarks || landmarks_now < options.min_tracked_share * landmarks_last;
  return sees_little && fresh_tracks > options.min_fresh_share * tracks_now;
}

void keepLastView(Window& window, int recent_frames, int least_landmarks) {
  int later = 0;
  for (auto frame = window.frames().rbegin(); frame != window.frames().rend(); ++frame, ++later) {
    if (!(*frame)->has_motion) return;
    const auto seen = std::count_if(window.tracks().begin(), window.tracks().end(), [&](const auto& entry) {
      return entry.second.landmark && entry.second.seenIn((*frame)->id);
    });
    if (seen < least_landmarks) continue;
    if (later >= recent_frames) (*frame)->is_keyframe = true;
    return;
  }
}

}  // namespace lodeline
