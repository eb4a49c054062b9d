#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <vector>

#include "lodeline/batch/estimator_log.h"
#include "lodeline/batch/loops/loop_observation.h"
#include "lodeline/mapping/session/dive_mapping.h"
#include "simulation/dive/point_simulation.h"
#include "simulation/plan/cave_plan.h"

namespace lodeline {

/// Test support: a dive of points through a cave, with a map. Descriptors belong to the physical points, so
/// that another visit sees them again, with wrong bits. Some points have the descriptor of another one.
struct MappedDiveOptions {
  CavePlanOptions cave;
  uint64_t dive_seed = 1;
  double speed_m_per_s = 0.35;
  double frame_rate_hz = 4.0;
  int tracks = 90;
  double wrong_bits = 0.08;   ///< share of a descriptor's bits that are wrong in each image
  double alike_share = 0.05;  ///< of the points
  /// Errors of the given calibration: focal lengths and baseline, relative, and the second camera's rotation.
  double focal_length_error = 0.003, baseline_error = 0.005, rotation_error_rad = 0.001;
  /// AprilTags on the line, seen with errors of a real camera. `tag_numbers`: of tags that carry the number
  /// of another one.
  int tags = 0;
  std::map<int, int> tag_numbers;
  bool recognizes_places = true;  ///< false: keyframes have no features, as in silt
  EstimatorOptions estimator;
  MappingOptions mapping;
};

/// What a dive of points is simulated from: motion, points, rigs and the errors of all readings.
struct MappedScene {
  Motion motion;
  LandmarkField landmarks;
  Rig true_rig, given_rig;
  PointSimulationOptions points;
  Vec3 cave_origin_W = Vec3::Zero();  ///< p_W = p_cave + cave_origin_W
};

struct MappedDive {
  /// Writes `file`, the map of the dive. `earlier`: map to start from; null for none.
  MappedDive(const MappedDiveOptions& options, const std::filesystem::path& file, const MapFile* earlier);
  /// The same in a given scene, in place of that of the options.
  MappedDive(const MappedScene& scene, const MappedDiveOptions& options, const std::filesystem::path& file,
             const MapFile* earlier);

  Rig rig;  ///< as given to the estimator
  EstimatorOptions options;
  EstimatorLog record;
  /// Of every frame with a pose: the truth and the odometry in the estimator's world, and the causal map
  /// pose.
  std::vector<Rigid3> truth, odometry, in_map;
  std::vector<Time> times;  ///< of the same frames
  std::vector<bool> is_placed;
  Vec3 cave_origin_W = Vec3::Zero();       ///< p_W = p_cave + cave_origin_W in the simulator's world
  std::vector<Rigid3> true_in_simulation;  ///< true poses in the simulator's world, same frames
  MappingSummary summary;
  std::vector<Loop> ledger;
  std::map<KeyframeId, Rigid3> true_poses;  ///< of the keyframes, in the frame of the cave
  std::vector<VerifiedLoop> accepted;
  LoopClosures closures;
  /// Error of the relative position of each accepted loop within the dive, m, and the squared error of its
  /// relative pose by its covariance (6 degrees of freedom).
  std::vector<double> loop_errors_m, loop_errors_squared;
  std::optional<Time> first_loop;  ///< time of the keyframe that closed the first accepted loop
};

/// Root mean square of the distances between positions.
double positionRms(const std::vector<Rigid3>& poses, const std::vector<Rigid3>& truth);

}  // namespace lodeline
