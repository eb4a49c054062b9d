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
#include "lodeline/estimator/state/parameter_block.h"
#include "lodeline/factors/calibrated_reprojection_factor.h"
#include "lodeline/factors/interpolated_pose.h"
#include "lodeline/factors/parameters.h"
#include "lodeline/factors/reprojection_factor.h"
#include "lodeline/factors/sensors/depth_factor.h"
#include "lodeline/factors/sensors/magnetometer_field_factor.h"
#include "lodeline/frontend/tracking/tracks.h"
#include "lodeline/imu/preintegration.h"
#include "lodeline/imu/propagation.h"
#include "lodeline/util/time/time.h"

namespace lodeline {

using FrameId = int64_t;
using PoseBlock = std::array<double, kPoseSize>;
using MotionBlock = std::array<double, kMotionSize>;

/// What the magnetometer says of a frame.
struct FieldMeasurement {
  MagnetometerMean mean;
  bool relative = false;  ///< against the frame before (MagnetometerRelativeFactor), not against the field
  FieldNoise noise;
  bool disturbed = false;  ///< the field has a disturbance to be estimated
};

/// What the pressure sensor says of a frame.
struct DepthMeasurement {
  CarriedDepth depth;
  double sigma_m = 0.0;
};

/// A frame without a state of its own: the keyframes that its pose hangs between.
struct Interpolated {
  FrameId before = 0, after = 0;
  PoseInterpolation between;
};

/// The state at one image time. Old keyframes keep their pose only, frames between them not even that.
struct Frame {
  FrameId id = 0;
  Time time;
  bool is_keyframe = false;
  std::optional<Interpolated> interpolated;
  PoseBlock pose{};
  bool has_motion = true;
  MotionBlock motion{};
  Vec3 gyroscope_B = Vec3::Zero();  ///< the gyroscope's reading at `time`, rad/s
  /// As of the last time that the frame had its motion, see updateImageMotion().
  ImageMotion image_motion;
  /// Where the block was first linearized by the marginalization prior; empty while the prior does not touch
  /// it.
  std::optional<PoseBlock> first_pose;
  std::optional<MotionBlock> first_motion;
  /// Inertial readings since the frame before, while that frame has its motion too.
  std::unique_ptr<Preintegration> from_previous;
  /// Until it has become part of the prior.
  std::optional<FieldMeasurement> magnetometer;
  std::optional<DepthMeasurement> depth;
  std::optional<double> rest_sigma_m_per_s;  ///< where the rig rests: the velocity is zero, known so well
  /// Width of the robust loss on its reprojection errors, standard deviations; as the options say until these
  /// have shown what it should be.
  std::optional<double> robust_scale_sigmas;

  Rigid3 worldFromBody() const { return poseFromBlock(pose.data()); }
  Vec3 velocity_W() const { return Vec3(motion.data()); }
  Vec3 gyroscopeBias() const { return Vec3(motion.data() + 3); }
  Vec3 accelerometerBias() const { return Vec3(motion.data() + 6); }
  NavigationState state() const;
  void setState(const NavigationState& state);
  /// Brings `image_motion` up to date, which old keyframes keep.
  void updateImageMotion();
  /// Where Jacobians are taken: at the linearization point, or at the present value where there is none.
  Rigid3 firstWorldFromBody() const { return poseFromBlock(first_pose ? first_pose->data() : pose.data()); }
  const double* firstPose() const { return first_pose ? first_pose->data() : nullptr; }
  const double* firstMotion() const { return first_motion ? first_motion->data() : nullptr; }
};

/// One image's view of a track.
struct Observation {
  FrameId frame = 0;
  int camera = 0;
  DirectionMeasurement measurement;
};

/// The position of a tracked point relative to its host frame (see LandmarkBase); hosts are seen by camera 0.
struct Landmark {
  FrameId host = 0;
  LandmarkBase base;
  std::array<double, kLandmarkSize> parameters{};

  double inverseDistance() const { return parameters[2]; }
};

/// A landmark that nothing will change any more.
struct MapPoint {
  TrackId track = -1;
  Vec3 position_W = Vec3::Zero();  ///< m
  int observations = 0;            ///< in the window when it left
};

/// All that the window knows of one tracked point.
struct FeatureTrack {
  std::vector<Observation> observations;  ///< in order of time, then camera
  std::optional<Landmark> landmark;
  double weight = 1.0;     ///< of its reprojection errors, squared (robust_loss.h)
  bool is_frozen = false;  ///< its terms are among LandmarkLinearizationCache

  std::span<const Observation> in(FrameId frame) const;
  const Observation* find(FrameId frame, int camera) const;  ///< null where there is none
  bool seenIn(FrameId frame) const { return !in(frame).empty(); }
  int frameCount() const;  ///< frames that see it, with whatever camera
  /// Whether it is the one that its landmark is hosted at.
  bool isHosted(const Observation& observation) const {
    return landmark && observation.frame == landmark->host && observation.camera == 0;
  }
};

/// By their numbers, side by side in memory: a frame walks through them many times over. New ones come last.
using Tracks = boost::container::flat_map<TrackId, FeatureTrack>;
/// Tracks with fewer observations are forgotten.
void removeShortTracks(Tracks& tracks, size_t least_observations);

/// The sliding window: old keyframes (poses) and interpolated frames between them, then the most recent
/// frames (poses and motions), the tracks they see, and what belongs to no frame.
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

  /// References to a track stay valid until tracks come or go.
  Tracks& tracks() { return tracks_; }
  const Tracks& tracks() const { return tracks_; }

  /// Adds a state that belongs to no frame; the reference stays valid as long as the window's contents.
  ParameterBlock& add(ParameterBlock state);
  /// In the order in which they were added.
  const std::vector<std::unique_ptr<ParameterBlock>>& globals() const { return globals_; }
  /// Null where there is none of that name.
  ParameterBlock* findGlobal(std::string_view name) const;

  /// Lets the pose of a frame, which loses its motion, follow from those of two keyframes from now on. Its
  /// observations stay.
  void interpolate(Frame& frame, const Frame& before, const Frame& after);
  /// Brings poses and linearization points of interpolated frames up to date, after keyframes have moved.
  void placeInterpolated();

  /// Forgets a frame, and those interpolated from it, with all their observations. No landmark may be hosted
  /// there any more.
  void remove(FrameId id);
  /// Tracks without observations are forgotten.
  void removeEmptyTracks();

 private:
  std::deque<std::unique_ptr<Frame>> frames_;
  Tracks tracks_;
  std::vector<std::unique_ptr<ParameterBlock>> globals_;
};

}  // namespace lodeline
