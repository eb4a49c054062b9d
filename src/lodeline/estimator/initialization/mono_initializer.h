#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lodeline/estimator/options/options.h"
#include "lodeline/estimator/problem/factor_builder.h"
#include "lodeline/estimator/state/window.h"
#include "lodeline/estimator/zero_velocity/stationary_detector.h"

namespace lodeline {

/// Observations of one frame with their tracks.
using ObservationList = std::vector<std::pair<TrackId, Observation>>;

/// Finds the first states of a rig whose images overlap only over time: visual structure from the frame that
/// has moved far enough against an earlier one, then gyroscope bias, gravity, scale and velocities from the
/// inertial readings, then everything together. Frames are collected until that succeeds.
class MonoInitializer {
 public:
  MonoInitializer(const Rig& rig, const EstimatorOptions& options, const FactorBuilder& factors)
      : rig_(rig), options_(options), factors_(factors) {}

  /// What StationaryDetector has found, as of a frame.
  struct Rest {
    bool now = false;  ///< its velocity is to be counted as none
    std::optional<GyroscopeAtRest> gyroscope;
  };

  /// Adds a frame: its observations and the inertial readings since the frame before (as Estimator::add).
  /// True when the window is complete: states of all its frames in a world with gravity down, zero yaw and
  /// origin at the first frame, landmarks in metres.
  bool add(Time time, const ObservationList& observations, std::span<const ImuSample> imu, FrameId id,
           const Rest& rest);

  /// What is missing, in words; set whenever add() returned false.
  const std::string& waitingFor() const { return waiting_for_; }

  Window takeWindow() { return std::move(window_); }
  /// The prior on the first frame that the window was solved with.
  Prior takePrior() { return std::move(prior_); }

 private:
  void insert(Time time, const ObservationList& observations, FrameId id);
  void dropOldestFrame();
  std::vector<Preintegration*> intervals() const;
  bool solveVisualStructure();
  /// What goes with these rotations of all frames, or more precisely what rests say where that does not
  /// contradict it; the intervals are integrated at it.
  Vec3 gyroscopeBias(const std::vector<Quat>& rotations);
  bool alignWithInertial();
  bool refine();

  const Rig& rig_;
  const EstimatorOptions& options_;
  const FactorBuilder& factors_;
  Window window_;
  Prior prior_;
  std::vector<ImuSample> pending_imu_;  ///< since the newest frame of the window
  bool pending_rest_ = false;           ///< of a frame that was left out
  std::optional<GyroscopeAtRest> gyroscope_;
  /// Inertial readings that led to a frame; kept apart from the window while its structure is purely visual.
  std::map<FrameId, std::unique_ptr<Preintegration>> intervals_;
  std::optional<Time> refused_;  ///< when a start was found, and found not to be good enough
  std::string waiting_for_;
};

}  // namespace lodeline
