#include "lodeline/mapping/session/map_north.h"

#include <algorithm>

#include "lodeline/mapping/graph/graph_gauge.h"

namespace lodeline {
namespace {

int rank(HeadingReference north) {
  switch (north) {
    case HeadingReference::True:
      return 2;
    case HeadingReference::Magnetic:
      return 1;
    case HeadingReference::Automatic:
    case HeadingReference::Start:
      return 0;
  }
  return 0;
}

}  // namespace

double northSigma_rad(HeadingReference map, HeadingReference dive) {
  constexpr double kDeclination_rad = 0.35;
  if (map == dive) return 0.0;
  return rank(map) > 0 && rank(dive) > 0 ? kDeclination_rad : kWeakRotation_rad;
}

HeadingReference northOf(const MapFile& map) {
  HeadingReference best = HeadingReference::Start;
  for (const MapDive& dive : map.dives()) {
    if (rank(dive.heading_reference) > rank(best)) best = dive.heading_reference;
  }
  return best;
}

}  // namespace lodeline
