#include "simulation/sensors/landmarks_along.h"

#include <utility>
#include <vector>

#include "simulation/shared/random.h"

namespace lodeline {

LandmarkField landmarksAlong(const Motion& motion, uint64_t seed) {
  Random random(seed, "landmarks along the path");
  std::vector<LandmarkPoint> points;
  for (double t = 0.0; t <= motion.duration_s(); t += 0.5) {
    const Vec3 here_W = motion.at(t).world_from_body.translation;
    for (int i = 0; i < 40; ++i) {
      const Vec3 direction = random.direction();
      points.push_back({here_W + random.uniform(2.0, 6.0) * direction, -direction});
    }
  }
  return LandmarkField(std::move(points));
}

}  // namespace lodeline
