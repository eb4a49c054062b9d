#pragma once

#include <string>
#include <vector>

#include "lodeline/mapping/graph/keyframe_factors.h"
#include "lodeline/mapping/store/map_file.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {

struct MapSolutionOptions {
  PoseGraphOptions graph;
  KeyframeFactorOptions factors;
  ShareDone progress = [](double) {};  ///< takes the share of the steps that are done
};

/// A control point at the common solution.
struct ControlResidual {
  std::string name;
  std::string dive;
  Vec3 residual_m = Vec3::Zero();
  double chi_squared = 0.0;
  bool is_used = true;
  std::string reason;  ///< for which it is not used
};

struct MapSolution {
  bool converged = false;
  int dives = 0, keyframes = 0, loops = 0, refused_loops = 0;
  std::vector<ControlResidual> control;
  std::vector<std::string> unconnected;  ///< dives that neither loops nor control points join to the first
};

/// Solves for the poses of all keyframes of a map at once: odometry, gravity, north, depth, loops and control
/// points. Writes poses and covariances, and the loops that the solution refuses, in one transaction. Throws
/// EstimationError where the solver fails; the map is then as before.
MapSolution solveMap(MapFile* map, const MapSolutionOptions& options);

}  // namespace lodeline
