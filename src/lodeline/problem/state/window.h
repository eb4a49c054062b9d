#pragma once

#include <array>
#include <boost/container/flat_map.hpp>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "lodeline/ahrs/magnetometer_mean.h"
#include "lodeline/estimate.h"
#include "lodeline/factors/calibrated_reprojection_factor.h"
#include "lodeline/factors/interpolated_pose.h"
#include "lodeline/factors/parameters.h"
#include "lodeline/factors/reprojection_factor.h"
#include "lodeline/frontend/tracking/tracks.h"
#include "lodeline/imu/preintegration.h"
#include "lodeline/imu/propagation.h"
#include "lodeline/problem/state/measurement.h"
#include "lodeline/problem/state/parameter_block.h"
#include "lodeline/types.h"

namespace lodeline {

using FrameId = int64_t;
using PoseBlock = std::array<double, kPoseSize>;
using MotionBlock = std::array<double, kMotionSize>;

/// Pose of a frame without a state: the keyframes between which it is interpolated.
struct Interpolated {
  FrameId before = 0, after = 0;
  PoseInterpolation between;
};

/// State at one image time. Old keyframes keep only their pose; frames between them have no state of their
/// own.
struct Frame {
  FrameId id = 0;
  Time time;
  bool is_keyframe = false;
  std::optional<Interpolated> interpolated;
  PoseBlock pose{};
  bool has_motion = true;
  MotionBlock motion{};
  Vec3 gyroscope_B = Vec3::Zero();  ///< the gyroscope's reading at `time`, rad/s
  /// Motion as of the last time when the frame had its motion block, see updateImageMotion().
  ImageMotion image_motion;
  /// Linearization point, set by the marginalization prior; empty while the prior does not contain the block.
  std::optional<PoseBlock> first_pose;
  std::optional<MotionBlock> first_motion;
  /// Inertial readings since the frame before, while that frame has its motion block too.
  std::unique_ptr<Preintegration> from_previous;
  Measurements measurements;                 ///< of the sensors, until they become part of the prior
  std::optional<double> rest_sigma_m_per_s;  ///< sigma of a zero-velocity update, where the rig rests
  /// Width of the robust loss on the frame's reprojection residuals, in standard deviations. Empty: the value
  /// of the options, until there are residuals to compute it from.
  std::optional<double> robust_scale_sigmas;

  Rigid3 worldFromBody() const { return poseFromBlock(pose.data()); }
  Vec3 velocity_W() const { return Vec3(motion.data()); }
  Vec3 gyroscopeBias() const { return Vec3(motion.data() + 3); }
  Vec3 accelerometerBias() const { return Vec3(motion.data() + 6); }
  NavigationState state() const;
  void setState(const NavigationState& state);
  /// Updates `image_motion`, which old keyframes keep.
  void updateImageMotion();
  /// Pose at which Jacobians are taken: the linearization point, or the present value where there is none.
  Rigid3 firstWorldFromBody() const { return poseFromBlock(first_pose ? first_pose->data() : pose.data()); }
  const double* firstPose() const { return first_pose ? first_pose->data() : nullptr; }
  const double* firstMotion() const { return first_motion ? first_motion->data() : nullptr; }
};

/// Measurement of a track in one image.
struct Observation {
  FrameId frame = 0;
  int camera = 0;
  DirectionMeasurement measurement;
};

/// Position of a tracked point relative to its host frame (see LandmarkBase); camera 0 of the host observes
/// it.
struct Landmark {
  FrameId host = 0;
  LandmarkBase base;
  std::array<double, kLandmarkSize> parameters{};

  double inverseDistance() const { return parameters[2]; }
};

/// Observations of one tracked point, and its landmark.
struct FeatureTrack {
  std::vector<Observation> observations;  ///< in order of time, then camera
  std::optional<Landmark> landmark;
  double weight = 1.0;     ///< of its squared reprojection residuals (robust_loss.h)
  bool is_frozen = false;  ///< its terms are in the LandmarkLinearizationCache

  std::span<const Observation> in(FrameId frame) const;
  const Observation* find(FrameId frame, int camera) const;  ///< null where there is none
  bool seenIn(FrameId frame) const { return !in(frame).empty(); }
  int frameCount() const;  ///< frames that observe it, with any camera
  /// Whether the observation defines the landmark's host ray.
  bool isHosted(const Observation& observation) const {
    return landmark && observation.frame == landmark->host && observation.camera == 0;
  }
};

/// Tracks by their numbers, contiguous in memory because a frame iterates over them many times. New ones come
/// last.
using Tracks = boost::container::flat_map<TrackId, FeatureTrack>;
/// Removes tracks with fewer observations.
void removeShortTracks(Tracks& tracks, size_t least_observations);

/// The sliding window: old keyframes (poses) and interpolated frames between them, recent frames (poses and
/// motions), their tracks, and parameter blocks of no frame.
class Window {
 public:
  Frame& add(std::unique_ptr<Frame> frame);
  void addObservation(TrackId track, const Observation& observation);

  bool empty() const { return frames_.empty(); }
  /// In order of time. Pointers stay valid until the frame is removed.
  const std::deque<std::unique_ptr<Frame>>& frames() const { return frames_; }
  Frame& newest() const { return *frames_.back(); }
  Frame* find(FrameId id) const;
  Frame* newestKeyframe() const;
  int recentCount() const;    ///< frames with motion
  int poseOnlyCount() const;  ///< keyframes without motion
  /// Oldest frame with motion, and the one after it (null if there is none).
  Frame* oldestRecent() const;
  Frame* after(const Frame& frame) const;

  /// References to a track stay valid until tracks are added or removed.
  Tracks& tracks() { return tracks_; }
  const Tracks& tracks() const { return tracks_; }

  /// Adds a state that belongs to no frame; the reference stays valid as long as the window.
  ParameterBlock& add(ParameterBlock state);
  /// In the order in which they were added.
  const std::vector<std::unique_ptr<ParameterBlock>>& globals() const { return globals_; }
  /// Null where no block has that name.
  ParameterBlock* findGlobal(std::string_view name) const;

  /// Interpolates the pose of a frame, which loses its motion, between two keyframes from now on. Its
  /// observations stay.
  void interpolate(Frame& frame, const Frame& before, const Frame& after);
  /// Updates poses and linearization points of interpolated frames after keyframes have moved.
  void placeInterpolated();

  /// Removes a frame, and those interpolated from it, with all their observations. It must not be the host of
  /// any landmark.
  void remove(FrameId id);
  /// Removes tracks without observations.
  void removeEmptyTracks();

 private:
  std::deque<std::unique_ptr<Frame>> frames_;
  Tracks tracks_;
  std::vector<std::unique_ptr<ParameterBlock>> globals_;
};

}  // namespace lodeline
