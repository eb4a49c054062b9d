#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "lodeline/cameras/camera.h"
#include "lodeline/frontend/tracking/tracks.h"
#include "simulation/sensors/dvl_model.h"
#include "simulation/sensors/imu_model.h"
#include "simulation/sensors/landmark_field.h"
#include "simulation/sensors/magnetometer_model.h"
#include "simulation/sensors/sonar_model.h"
#include "simulation/shared/motion.h"
#include "simulation/vehicle/vehicle_currents.h"

namespace lodeline {

/// A time interval, s from the start of the motion.
struct MotionInterval {
  double begin_s = 0.0;
  double duration_s = 0.0;
  bool contains(double t) const { return t >= begin_s && t < begin_s + duration_s; }
};

/// A magnetometer on the rig; its rate is that of the rig's calibration.
struct PointMagnetometer {
  Vec3 field_W = Vec3(0.0, 24e-6, -38e-6);  ///< the Earth's field, T
  MagneticDisturbances disturbances;
  MagnetometerErrors errors;
};

/// Sensors of a vehicle; their rates and poses are those of the true rig.
struct PointVehicle {
  RangeFunction range;  ///< to the surface, for DVL and altimeter
  DvlErrors dvl;
  SonarErrors altimeter;
  LoadsFunction loads;  ///< empty: no readings of currents
  CurrentSensorErrors current_sensor;
  /// Shakes a perfect reading of the IMU; called in order of time. Empty: no vibration.
  std::function<void(double time_s, ImuSample* reading)> shake;
};

struct PointSimulationOptions {
  uint64_t seed = 1;
  Time start = Time::fromNanoseconds(1'800'000'000'000'000'000);  ///< stamp at second 0 of the motion
  double frame_rate_hz = 20.0;
  /// Time of the first image; inertial readings start with the motion.
  double first_frame_s = 1.0;
  double end_s = 1e9;  ///< clipped to the motion's duration

  int tracks = 150;  ///< target number per frame
  /// Detects visible points in one fixed order, as a detector does by the strength of corners. Most points
  /// are then seen again at the next visit. Otherwise, detects them at random.
  bool strongest_first = false;
  double pixel_sigma_px = 0.5;  ///< true noise, and stated sigma of the observations
  double outlier_share = 0.0;   ///< fraction of observations, displaced by 5 to 50 px
  double longest_track_s = 10.0;
  double nearest_m = 0.3;
  double farthest_m = 8.0;
  double stereo_share = 1.0;  ///< fraction of observations that are also visible in the second camera
  double dropped_frame_share = 0.0;
  std::vector<MotionInterval> blackouts;  ///< intervals with frames but without features

  ImuErrors imu;
  std::optional<PointMagnetometer> magnetometer;  ///< requires a rig with a magnetometer
  std::optional<PointVehicle> vehicle;            ///< requires a rig with its sensors
  Vec3 gravity_W = Vec3(0.0, 0.0, -9.80665);
};

/// True state at a frame in the parametrization of the estimator.
struct TrueState {
  Time time;
  MotionState motion;
  Vec3 gyroscope_bias_B = Vec3::Zero();
  Vec3 accelerometer_bias_B = Vec3::Zero();
};

/// Estimator input for one frame, with the true state.
struct SimulatedFrame {
  FrameTracks tracks;
  /// Readings from the previous frame to this one, both ends at the frames' times; for the first frame, from
  /// the motion's start. As in a synchronizer, ends between two readings are interpolated.
  std::vector<ImuSample> imu;
  /// Readings after the previous frame up to this one; for the first frame, from the motion's start.
  std::vector<MagnetometerSample> magnetometer;
  std::vector<DvlSample> dvl;  ///< these three in the same interval
  std::vector<AltimeterSample> altimeter;
  std::vector<CurrentSample> currents;
  TrueState truth;
};

/// Simulates a dive without images: points on the walls, projected through the true rig with pixel noise, and
/// inertial readings. A track ends when it leaves the view or reaches its maximum age; a point seen again
/// gets a new identity. The simulation is a stream, so memory use does not depend on the length of the dive.
class PointSimulation {
 public:
  /// `rig` is both the true and the calibrated rig. All cameras must have the same rate. Throws InputError
  /// where a camera cannot be created.
  PointSimulation(const Motion& motion, const LandmarkField& landmarks, const Rig& rig,
                  const PointSimulationOptions& options);
  /// Projects with `true_rig` and computes bearings with `given_rig`.
  PointSimulation(const Motion& motion, const LandmarkField& landmarks, const Rig& true_rig,
                  const Rig& given_rig, const PointSimulationOptions& options);

  /// The next frame, or nothing at the end.
  std::optional<SimulatedFrame> next();

  /// The true surface point of a track.
  Vec3 landmark(TrackId track) const { return landmarks_.points()[pointOf(track)].position_W; }

  /// Index of the surface point of a track in the landmark field. Tracks of one point at several visits, or
  /// in several dives of one cave, have the same index.
  int pointOf(TrackId track) const { return point_of_track_.at(track); }

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
  void takeVehicle(SimulatedFrame& frame);
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
  std::optional<DvlModel> dvl_;
  std::optional<SonarModel> altimeter_;
  std::optional<CurrentSensorModel> currents_;
  Random pixel_noise_, choice_;
  int next_frame_ = 0;
  int64_t next_imu_ = 0;
  int64_t next_magnetometer_ = 0;
  int64_t next_dvl_ = 0, next_altimeter_ = 0, next_currents_ = 0;
  std::optional<Reading> before_, after_;  // readings on both sides of the last border
  std::optional<ImuSample> border_;
  std::vector<Track> tracks_;
  std::vector<int> point_of_track_;
};

}  // namespace lodeline
