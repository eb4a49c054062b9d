#pragma once

#include <optional>
#include <vector>

#include "lodeline/simulation.h"
#include "simulation/motion/dive_motion.h"
#include "simulation/motion/swim_route.h"
#include "simulation/rendering/board/line_tag.h"
#include "simulation/rendering/cave/cave_layout.h"

namespace lodeline {

struct CavePlanOptions {
  CaveShape shape = CaveShape::Loop;
  uint64_t seed = 1;             ///< of the cave; a dive has another one
  double path_length_m = 150.0;  ///< Passage: both ways; Loop: all laps; Junction and Room: all of the dive
  std::optional<double> cave_length_m;  ///< of a Passage, up to its far end; half of the path where not given
  int laps = 2;                         ///< Loop and Room
  int entrance = 1;                     ///< Passage: 1 at the start, 2 at the far end
  bool decorated = false;
};

/// A cave and a way through it, in the frame C of the cave: east, north, up, with the origin on the middle
/// line where dives from entrance 1 start. Both depend on the options alone.
struct CavePlan {
  CaveLayout cave;
  SwimRoute route;
  std::vector<LinedStretch> line;  ///< from the entrance on, the same for every entrance
};

/// Passage: in to half of the path, and back. Loop: a way in of 14 m, then laps of path_length_m / laps each,
/// and a tenth of one more. Junction: along the main passage, into a branch and back, on to the far end, and
/// back out. Room: a way in of 10 m, then rounds through one chamber that drift inwards and outwards. Throws
/// UsageError for lengths and laps without such a cave.
CavePlan planCave(const CavePlanOptions& options);

/// A motion in the cave of a plan made with `cave`, whose path length counts. In a passage, the path of the
/// body has that length to 1 %; elsewhere, the route has its own.
Motion makePlannedMotion(const CavePlan& plan, const CavePlanOptions& cave, const DiveMotionOptions& options,
                         const Rigid3& diver_from_body);

/// Shape of the main passage.
CenterlineOptions passageOptions(const CavePlanOptions& options);

}  // namespace lodeline
