#pragma once

#include "simulation/rendering/optics/flat_port.h"

namespace lodeline {

/// A dome between camera and water: two concentric spheres. With its centre in the centre of projection, rays
/// pass straight. A decentred dome bends them, and no central projection describes the camera exactly
/// (M. She et al., "Refractive geometry for underwater domes", ISPRS Journal 2022).
struct DomePort {
  Vec3 centre_C = Vec3::Zero();  ///< of both spheres, m
  double radius_m = 0.045;       ///< of the inner face
  double thickness_m = 0.004;
  double index_glass = 1.49;  ///< acrylic
  double index_water = 1.335;
};

/// The ray in the water of a ray that leaves the centre of projection in air; nothing where it does not pass.
std::optional<WaterRay> throughPort(const DomePort& port, const Vec3& direction_air_C);

}  // namespace lodeline
