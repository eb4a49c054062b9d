#pragma once

#include "lodeline/estimate.h"
#include "lodeline/mapping/store/map_file.h"

namespace lodeline {

/// Sigma of the angle between the y axis of a map and the north of a dive's headings, rad: 0 where both are
/// the same north. Between true and magnetic north lies the declination: 0.35 rad covers nearly all waters.
/// Nothing is known where the map counts from the start of a dive.
double northSigma_rad(HeadingReference map, HeadingReference dive);

/// The north of a map that is solved: the best that any of its dives knows (true, magnetic, start).
HeadingReference northOf(const MapFile& map);

}  // namespace lodeline
