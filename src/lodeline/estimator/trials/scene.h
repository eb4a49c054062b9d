#pragma once

#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/estimator/estimator.h"
#include "simulation/dive/point_simulation.h"

namespace lodeline {

/// Test support: a rig that sways and turns in a round room, simulated as tracks of points and inertial
/// readings.
struct TestSceneOptions {
  uint64_t seed = 1;  ///< of noise, points, biases and the phases of the motion
  int cameras = 2;
  double duration_s = 20.0;
  double liveliness = 1.0;   ///< 1: about 1 m/s, 1.5 m/s^2 and 0.5 rad/s; scales position and rotation
  double translation = 1.0;  ///< scales the sway of the position once more; 0 turns on the spot
  /// Additional yaw rate from 5 s on, at most this much.
  double hurry_rad_per_s = 0.0;
  Vec3 drift_m_per_s = Vec3::Zero();        ///< constant velocity on top
  std::vector<MotionInterval> still;        ///< the sway fades within 3 s of their borders
  double wall_roughness_m = 1.0;            ///< greatest distance of the points from the wall of the room
  std::vector<MotionInterval> on_the_spot;  ///< only the sway of the position fades
  PointSimulationOptions points;            ///< seed, end and IMU errors are filled in by the scene
  /// Sigmas, per axis, of the distribution of the initial biases.
  double gyroscope_bias_sigma_rad_per_s = 0.02;
  double accelerometer_bias_sigma_m_per_s2 = 0.05;
};

/// Streams the frames of a scene. The rig's stated noise is exactly that of its readings.
class TestScene {
 public:
  explicit TestScene(const TestSceneOptions& options);
  TestScene(const TestScene&) = delete;

  const Rig& rig() const { return rig_; }
  std::optional<SimulatedFrame> next() { return simulation_.next(); }
  std::vector<SimulatedFrame> all();
  Vec3 landmark(TrackId track) const { return simulation_.landmark(track); }
  const Motion& motion() const { return motion_; }
  /// Distance from a point along a unit direction to the wall of the room, m; floor and ceiling are missing.
  double distanceToWall_m(const Vec3& origin_W, const Vec3& direction_W) const;
  /// Seconds since the start of the motion.
  double secondsOf(Time time) const { return (time - start_).seconds(); }

 private:
  Time start_;
  Rig rig_;
  Motion motion_;
  LandmarkField landmarks_;
  PointSimulation simulation_;
};

/// Rig with two undistorted cameras (or one), 11 cm apart, looking along the body's x axis, y to the left; a
/// pressure port 12 cm behind.
Rig testRig(int cameras);

/// Options of an estimator whose priors match a scene: noise as stated, biases as drawn.
EstimatorOptions honestOptions(const TestSceneOptions& scene);

/// Transformation of true poses into the estimator's world, whose origin and heading are those of its first
/// frame. The prior on that frame holds the z component of its rotation's perturbation at zero. The true
/// heading is transferred in the same way, however large the first tilt error was. `linearization_point`: the
/// pose around which the prior was built.
Rigid3 estimateFromTruth(const Rigid3& linearization_point, const Rigid3& first_truth);

/// An estimate together with the true state.
struct Comparison {
  double time_s = 0.0;  ///< since the start of the motion
  FrameEstimate estimate;
  Rigid3 true_world_from_body;  ///< in the estimator's world
  Vec3 true_velocity_W = Vec3::Zero();
  Vec3 true_gyroscope_bias_B = Vec3::Zero();
  Vec3 true_accelerometer_bias_B = Vec3::Zero();
  Eigen::Matrix<double, 6, 1> error = Eigen::Matrix<double, 6, 1>::Zero();  ///< [dp, dtheta], m and rad

  bool initialized() const { return estimate.status != Status::Waiting; }
  double positionError() const { return error.head<3>().norm(); }
  double rotationError() const { return error.tail<3>().norm(); }
};

/// Compares an estimator's output with the truth, frame by frame from the first.
class TruthComparison {
 public:
  Comparison compare(const SimulatedFrame& frame, const FrameEstimate& estimate, const Estimator& estimator);

 private:
  std::map<Time, Rigid3> true_poses_;  // until initialized
  std::optional<Rigid3> estimate_from_truth_;
  bool is_relative_to_north_ = false;  ///< the estimates are then turned to north
};

/// An estimator whose output is compared with the truth after every frame.
class ComparedEstimator {
 public:
  ComparedEstimator(const TestScene& scene, const EstimatorOptions& options)
      : ComparedEstimator(scene, options, scene.rig()) {}
  /// With further sensors in the rig.
  ComparedEstimator(const TestScene& scene, const EstimatorOptions& options, const Rig& rig)
      : scene_(scene), estimator_(rig, options, &diagnostics_) {}

  Comparison add(const SimulatedFrame& frame, std::span<const DepthSample> depth = {});
  Comparison add(const SimulatedFrame& frame, const SensorReadings& readings);

  const Estimator& estimator() const { return estimator_; }
  const Diagnostics& diagnostics() const { return diagnostics_; }

 private:
  const TestScene& scene_;
  Diagnostics diagnostics_;
  Estimator estimator_;
  TruthComparison comparison_;
};

/// Runs a whole scene.
std::vector<Comparison> compare(TestScene& scene, const EstimatorOptions& options);

}  // namespace lodeline
