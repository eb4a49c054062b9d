#include "lodeline/mapping/graph/motion/level_motion.h"

#include <cmath>
#include <numbers>

namespace lodeline {

double azimuthOf(const Quat& rotation) {
  if (rotation.w() == 0.0 && rotation.z() == 0.0) return 0.0;
  const double angle = 2.0 * std::atan2(rotation.z(), rotation.w());
  return std::remainder(angle, 2.0 * std::numbers::pi);
}

Rigid3 mapFromOdom(const Rigid3& map_from_body, const Rigid3& odom_from_body) {
  const double azimuth = azimuthOf(map_from_body.rotation * odom_from_body.rotation.conjugate());
  const Quat map_from_odom(Eigen::AngleAxisd(azimuth, Vec3::UnitZ()));
  return Rigid3(map_from_odom, map_from_body.translation - map_from_odom * odom_from_body.translation);
}

}  // namespace lodeline
