#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "lodeline/cameras/camera.h"
#include "lodeline/frontend/tracking/tracks.h"
#include "simulation/sensors/imu_model.h"
#include "simulation/sensors/landmark_field.h"
#include "simulation/sensors/magnetometer_model.h"
#include "simulation/shared/motion.h"

namespace lodeline {

/// A stretch of time, s from the start of the motion.
struct TimeSpan {
  double begin_s = 0.0;
  double duration_s = 0.0;
  bool contains(double t) const { return t >= begin_s && t < begin_s + duration_s; }
};

/// A magnetometer on board; its rate is that of the rig's calibration.
struct PointMagnetometer {
  Vec3 field_W = Vec3(0.0, 24e-6, -38e-6);  ///< of the Earth, T
  MagneticDisturbances disturbances;
  MagnetometerErrors errors;
};

struct PointSimulationOptions {
  uint64_t seed = 1;
  Time start = Time::fromNanoseconds(1'800'000'000'000'000'000);  ///< stamp of the motion's second 0
  double frame_rate_hz = 20.0;
  /// Inertial readings are given from the motion's start on, images from here on.
  double first_frame_s = 1.0;
  double end_s = 1e9;  ///< clipped to the motion's duration

  int tracks = 150;             ///< aimed at in each frame
  double pixel_sigma_px = 0.5;  ///< true noise; also stated as the observations' sigma
  double outlier_share = 0.0;   ///< of observations, displaced by 5 to 50 px
  double longest_track_s = 10.0;
  double nearest_m = 0.3;
  double farthest_m = 8.0;
  double stereo_share = 1.0;  ///< of observations that the second camera sees too
  double dropped_frame_share = 0.0;
  std::vector<TimeSpan> blackouts;  ///< frames come, with nothing to track in them

  ImuErrors imu;
  std::optional<PointMagnetometer> magnetometer;  ///< takes a rig with one
  Vec3 gravity_W = Vec3(0.0, 0.0, -9.80665);
};

/// The exact state at a frame, as the estimator parametrizes it.
struct TrueState {
  Time time;
  MotionState motion;
  Vec3 gyroscope_bias_B = Vec3::Zero();
  Vec3 accelerometer_bias_B = Vec3::Zero();
};

/// What the estimator is given for one moment, and the truth of it.
struct SimulatedFrame {
  FrameTracks tracks;
  /// From the frame before to this one, both ends on the frames' times; the first from the motion's start. A
  /// border between two readings is interpolated, as a synchronizer would.
  std::vector<ImuSample> imu;
  /// After the frame before and up to this one; the first from the motion's start.
  std::vector<MagnetometerSample> magnetometer;
  TrueState truth;
};

/// A dive without pictures: points on the walls seen through the true rig with pixel noise, and inertial
/// readings. Tracks live until they leave the view or grow too old, and get a new identity when seen again.
/// Streams, so that memory does not grow with the length of the dive.
class PointSimulation {
 public:
  /// `rig`: truth and calibration at once. All cameras must have the same rate. Throws InputError where a
  /// camera cannot be made.
  PointSimulation(const Motion& motion, const LandmarkField& landmarks, const Rig& rig,
                  const PointSimulationOptions& options);
  /// Seen through `true_rig`, bearings computed with `given_rig`.
  PointSimulation(const Motion& motion, const LandmarkField& landmarks, const Rig& true_rig,
                  const Rig& given_rig, const PointSimulationOptions& options);

  /// The next frame, or nothing at the end.
  std::optional<SimulatedFrame> next();

  /// The surface point behind a track that was given out.
  Vec3 landmark(TrackId track) const { return landmarks_.points()[point_of_track_.at(track)].position_W; }

 private:
  struct Track {
    TrackId id;
    int point;
    double born_s;
  };
  struct Reading {
    ImuSample sample;
    Vec3 gyroscope_bias, accelerometer_bias;
  };

  double secondsOf(int frame) const { return options_.first_frame_s + frame / options_.frame_rate_hz; }
  void takeImu(SimulatedFrame& frame);
  void takeMagnetometer(SimulatedFrame& frame);
  void renewTracks(double time_s, const Rigid3& world_from_body);
  std::optional<Vec2> seen(int camera, const Rigid3& world_from_body, const LandmarkPoint& point) const;
  void observe(const Rigid3& world_from_body, FrameTracks& tracks);
  void addObservation(TrackId track, int camera, const Vec2& true_pixel, FrameTracks& tracks);

  const Motion& motion_;
  const LandmarkField& landmarks_;
  Rig true_rig_;
  PointSimulationOptions options_;
  std::vector<std::shared_ptr<const Camera>> true_cameras_, given_cameras_;
  ImuModel imu_;
  std::optional<MagnetometerModel> magnetometer_;
  Random pixel_noise_, choice_;
  int next_frame_ = 0;
  int64_t next_imu_ = 0;
  int64_t next_magnetometer_ = 0;
  std::optional<Reading> before_, after_;  // readings around the last border
  std::optional<ImuSample> border_;
  std::vector<Track> tracks_;
  std::vector<int> point_of_track_;
};

}  // namespace lodeline
