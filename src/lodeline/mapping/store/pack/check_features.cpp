#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "lodeline/mapping/store/pack/feature_columns.h"

namespace lodeline {
namespace {

constexpr double kUnit = 1e-6;       ///< deviation of a unit vector's length
constexpr double kFarthest_m = 1e6;  ///< within which float32 keeps what is measured

void checkRay(const BodyRay& ray) {
  if (!ray.pixel.allFinite() || ray.pixel.cwiseAbs().maxCoeff() > 1e6)
    throw InputError("a pixel is not finite");
  if (!ray.origin_B.allFinite() || ray.origin_B.norm() > kFarthest_m)
    throw InputError("the origin of a ray is not finite");
  if (!(std::abs(ray.bearing_B.norm() - 1.0) < kUnit)) throw InputError("a bearing is no unit vector");
  if (!(ray.sigma_rad > 0.0) || !std::isfinite(ray.sigma_rad))
    throw InputError("the sigma of a ray is not positive");
}

void checkFeature(const MapFeature& feature) {
  if (feature.track < -1) throw InputError("the number of a track is negative");
  if (feature.rays.empty()) throw InputError("a feature has no ray");
  int last_camera = -1;
  for (const BodyRay& ray : feature.rays) {
    if (ray.camera <= last_camera || ray.camera >= kMostCamerasOfMap)
      throw InputError(
          fmt::format("the cameras of a feature are not in rising order up to {}", kMostCamerasOfMap - 1));
    last_camera = ray.camera;
    checkRay(ray);
  }
  if (!feature.point_B) return;
  if (!feature.point_B->allFinite() || feature.point_B->norm() > kFarthest_m)
    throw InputError("the point of a feature is not finite");
  if (!(feature.distance_sigma_m > 0.0) || !std::isfinite(feature.distance_sigma_m))
    throw InputError("the sigma of a distance is not positive");
}

}  // namespace

void checkFeatures(const std::vector<MapFeature>& features) {
  if (features.size() > std::numeric_limits<uint16_t>::max())
    throw InputError(fmt::format("a keyframe has {} features, more than 65535", features.size()));
  for (size_t i = 0; i < features.size(); ++i) {
    try {
      checkFeature(features[i]);
    } catch (const InputError& error) {
      throw InputError(fmt::format("feature {}: {}", i, error.what()));
    }
  }
}

}  // namespace lodeline
