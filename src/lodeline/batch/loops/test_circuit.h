#pragma once

#include <optional>
#include <vector>

#include "lodeline/batch/estimator_log.h"
#include "lodeline/batch/loops/loop_observation.h"
#include "lodeline/estimator/trials/scene.h"

namespace lodeline {

/// Test support: a passage that closes to a circle, swum several times.
struct BatchCircuitOptions {
  uint64_t seed = 1;
  double radius_m = 25.0;
  double laps = 2.0;
  double speed_m_per_s = 0.5;
  double frame_rate_hz = 4.0;
  int tracks = 60;
  double points_per_metre = 25.0;  ///< few, so that the second lap tracks points of the first one again
  /// Relative error of the given focal lengths and baseline, and of the second camera's rotation, rad.
  double focal_length_error = 0.003, baseline_error = 0.005, rotation_error_rad = 0.001;
};

/// A circuit run through the estimator without a magnetometer, with the true pose of every frame.
struct CircuitRun {
  Rig rig;  ///< as given to the estimator
  EstimatorOptions options;
  EstimatorLog record;
  std::vector<Rigid3> truth;  ///< of the frames of the record, in the estimator's world
  double lap_s = 0.0;         ///< duration of a lap
  /// Points in view of every frame of the record, with the track and the true point.
  struct Seen {
    FeatureObservation observation;
    Vec3 point_W;
  };
  std::vector<std::vector<Seen>> seen;

  explicit CircuitRun(const BatchCircuitOptions& options);

  double rootMeanSquare(const std::vector<FrameEstimate>& frames) const;
};

struct CircuitLoopOptions {
  double interval_s = 2.0;   ///< between images that are compared with the lap before
  double wrong_share = 0.0;  ///< of the loop observations: they are of another point in view
  bool are_tracked = true;   ///< false: as corners that were not tracked
};

/// The loops of the second lap, and initial poses like those of a pose graph: the misclosure of the first lap
/// is spread over its time. Images of the second lap are placed beside the first.
LoopClosures circuitLoops(const CircuitRun& run, const CircuitLoopOptions& options);

}  // namespace lodeline
