#include "lodeline/mapping/session/map_surface.h"

namespace lodeline {

std::optional<SurfaceHeight> surfaceOf(const MapFile& map) {
  std::optional<SurfaceHeight> best;
  for (const MapDive& dive : map.dives()) {
    map.forEachKeyframe(dive.id, [&](const StoredKeyframe& row) {
      const std::optional<ScalarPrior>& depth = row.keyframe.depth_m;
      if (!row.solved || !depth || (best && best->sigma_m <= depth->sigma)) return;
      best = SurfaceHeight{row.solved->map_from_body.translation.z() + depth->value, depth->sigma};
    });
  }
  return best;
}

}  // namespace lodeline
