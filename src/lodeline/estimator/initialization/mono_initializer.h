#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lodeline/estimator/initialization/visual_inertial_alignment.h"
#include "lodeline/estimator/sensor/sensor_fusion.h"
#include "lodeline/estimator/zero_velocity/stationary_detector.h"
#include "lodeline/problem/factor_builder.h"
#include "lodeline/problem/options/options.h"
#include "lodeline/problem/state/window.h"

namespace lodeline {

/// Observations of one frame with their tracks.
using ObservationList = std::vector<std::pair<TrackId, Observation>>;

/// Finds the first states of a rig whose images overlap only over time. It estimates the visual structure
/// once the newest frame has moved far enough from an earlier one. Then it estimates gyroscope bias, gravity,
/// scale and velocities from the inertial readings, and finally all variables together. A sensor of velocity
/// takes part in the last two steps. Frames are collected until that succeeds.
class MonoInitializer {
 public:
  using Sensors = std::vector<std::unique_ptr<SensorFusion>>;

  MonoInitializer(const Rig& rig, const EstimatorOptions& options, const FactorBuilder& factors)
      : rig_(rig), options_(options), factors_(factors) {}

  /// Result of StationaryDetector at a frame.
  struct Rest {
    bool now = false;  ///< the frame gets a zero-velocity update
    std::optional<GyroscopeAtRest> gyroscope;
  };

  /// Adds a frame: its observations and the inertial readings since the frame before (as in Estimator::add).
  /// Returns true when the window is complete: states of all its frames in a world with gravity down, zero
  /// yaw and origin at the first frame, landmarks in metres.
  bool add(Time time, const ObservationList& observations, std::span<const ImuSample> imu, FrameId id,
           const Rest& rest, const Sensors& sensors = {});

  /// The missing condition, in words; set whenever add() returned false.
  const std::string& waitingFor() const { return waiting_for_; }

  Window takeWindow() { return std::move(window_); }
  /// The prior on the first frame with which the window was solved.
  Prior takePrior() { return std::move(prior_); }

 private:
  void insert(Time time, const ObservationList& observations, FrameId id, const Sensors& sensors);
  void dropOldestFrame();
  std::vector<Preintegration*> intervals() const;
  bool solveVisualStructure();
  /// Gyroscope bias that fits these rotations of all frames. The more accurate bias from rests replaces it
  /// where both agree. The intervals are integrated with the result.
  Vec3 gyroscopeBias(const std::vector<Quat>& rotations);
  /// Of each frame.
  MeasuredVelocities measuredVelocities() const;
  bool alignWithInertial();
  /// Solves everything together. The window is complete if it returns true.
  bool refine(const Sensors& sensors);
  /// Gives the frames their intervals and measurements, or takes these back.
  void giveToFrames();
  void takeFromFrames();
  bool isGood(bool is_solved);

  const Rig& rig_;
  const EstimatorOptions& options_;
  const FactorBuilder& factors_;
  Window window_;
  Prior prior_;
  std::vector<ImuSample> pending_imu_;  ///< since the newest frame of the window
  bool pending_rest_ = false;           ///< zero-velocity update of a frame that was skipped
  std::optional<GyroscopeAtRest> gyroscope_;
  /// Inertial readings before each frame; kept apart from the window while its structure is purely visual.
  std::map<FrameId, std::unique_ptr<Preintegration>> intervals_;
  std::map<FrameId, Measurements> measurements_;  ///< the same for those of sensors
  std::optional<Time> refused_;  ///< time of the last start that was rejected as too inaccurate
  std::string waiting_for_;
};

}  // namespace lodeline
