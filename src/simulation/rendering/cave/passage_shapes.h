#pragma once

#include <cstdint>

#include "simulation/rendering/cave/centerline.h"

namespace lodeline {

/// A closed circuit. All lengths in m.
struct CircuitOptions {
  uint64_t seed = 1;
  double length_m = 75.0;  ///< once around
  double mean_width_m = 4.5;
  double mean_height_m = 2.8;
  double section_variation = 0.25;  ///< RMS relative change of width and height
};

/// A random circuit: a bulged ellipse that rises and falls, smooth and without seam in position, direction
/// and section. It runs to the left or to the right, by the seed. Throws UsageError for a circuit too short
/// for its width.
Centerline makeCircuit(const CircuitOptions& options);

/// A passage that leaves another one. All lengths in m.
struct BranchOptions {
  uint64_t seed = 1;
  double length_m = 30.0;      ///< from the fork to its far end
  double run_out_m = 8.0;      ///< passage beyond the far end
  double turn_rad = 1.2;       ///< change of azimuth; positive to the left
  double turn_radius_m = 5.0;  ///< of the tightest part of that turn
  double slope = 0.0;          ///< rise per length beyond the turn
  double bend_rad = 0.25;      ///< RMS of the bends beyond the turn
  double mean_width_m = 4.0;
  double mean_height_m = 2.6;
};

/// Length of the part of a branch that lies inside the other passage, before the fork at arc length 0.
constexpr double kBranchInset_m = 4.0;

/// A branch that leaves a passage at a station (`root`) along its tangent and with its section, then turns
/// aside. Before arc length 0, it shrinks within the other passage.
Centerline makeBranch(const PassageStation& root, const BranchOptions& options);

/// A chamber between two narrow ends. All lengths in m.
struct RoomOptions {
  uint64_t seed = 1;
  double scale = 1.0;  ///< of the chamber, which is 24 m long, 18 m wide and 6 m high for 1
};

/// A chamber along a straight line. The passage before it starts at arc length 0 and is 10 m long.
struct Room {
  Centerline passage;
  double begin_m = 0.0, end_m = 0.0;  ///< arc lengths at which the chamber starts and ends
};
Room makeRoom(const RoomOptions& options);

}  // namespace lodeline
