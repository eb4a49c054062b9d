#pragma once

#include <vector>

#include "simulation/rendering/cave/centerline.h"

namespace lodeline {

/// A way through a cave between two turns: along one of the route's tracks.
struct SwimLeg {
  int track = 0;
  double from_m = 0.0, to_m = 0.0;  ///< arc lengths on the track
};

/// A way through a cave. Each leg is swum against the direction of the one before it, which ends where it
/// begins. There the tracks of the two legs are the same line. The first leg begins at arc length 0.
struct SwimRoute {
  std::vector<Centerline> tracks;
  std::vector<SwimLeg> legs;

  double length_m() const;
  const Centerline& trackOf(int leg) const {
    return tracks[static_cast<size_t>(legs[static_cast<size_t>(leg)].track)];
  }
  SwimRoute translated(const Vec3& offset_W) const;
};

/// In to `penetration_m`, and back where asked.
SwimRoute straightRoute(const Centerline& passage, double penetration_m, bool round_trip);

}  // namespace lodeline
