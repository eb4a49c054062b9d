#include "simulation/motion/swim_route.h"

#include <cmath>

namespace lodeline {

double SwimRoute::length_m() const {
  double sum_m = 0.0;
  for (const SwimLeg& leg : legs) sum_m += std::abs(leg.to_m - leg.from_m);
  return sum_m;
}

SwimRoute SwimRoute::translated(const Vec3& offset_W) const {
  SwimRoute moved = *this;
  for (Centerline& track : moved.tracks) track = track.translated(offset_W);
  return moved;
}

SwimRoute straightRoute(const Centerline& passage, double penetration_m, bool round_trip) {
  SwimRoute route{{passage}, {{0, 0.0, penetration_m}}};
  if (round_trip) route.legs.push_back({0, penetration_m, 0.0});
  return route;
}

}  // namespace lodeline
