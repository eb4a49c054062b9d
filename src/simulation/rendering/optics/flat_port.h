#pragma once

#include <memory>

#include "lodeline/cameras/camera.h"

namespace lodeline {

/// A flat window between camera and water. Refraction occurs at both faces, so no central projection
/// describes the camera exactly (T. Treibitz et al., "Flat refractive geometry", PAMI 2012).
struct FlatPort {
  Vec3 normal_C =
      Vec3::UnitZ();  ///< normal of the glass towards the water; slightly off the axis in a real housing
  double distance_m = 0.015;  ///< from the camera's centre of projection to the inner face
  double thickness_m = 0.008;
  double index_glass = 1.49;  ///< acrylic
  double index_water = 1.335;
};

/// A ray in the water, camera frame.
struct WaterRay {
  Vec3 origin_C = Vec3::Zero();      ///< on the outer face, m
  Vec3 direction_C = Vec3::UnitZ();  ///< unit
};

/// Refracted direction for unit `direction` and unit `normal` on the far side of the surface (Snell's law in
/// vector form). `index_ratio` is the index of the near medium divided by that of the far one. Returns
/// nothing at total reflection.
std::optional<Vec3> refract(const Vec3& direction, const Vec3& normal, double index_ratio);

/// The ray in the water of a ray that leaves the centre of projection in air; nothing where it does not pass.
std::optional<WaterRay> throughPort(const FlatPort& port, const Vec3& direction_air_C);

}  // namespace lodeline
