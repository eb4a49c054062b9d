#pragma once

#include <memory>

#include "lodeline/cameras/camera.h"

namespace lodeline {

/// A flat window between camera and water. Rays bend at both faces, so no central projection describes the
/// camera exactly (T. Treibitz et al., "Flat refractive geometry", PAMI 2012).
struct FlatPort {
  Vec3 normal_C =
      Vec3::UnitZ();          ///< of the glass, out into the water; slightly off the axis in a real housing
  double distance_m = 0.015;  ///< from the camera's centre of projection to the inner face
  double thickness_m = 0.008;
  double index_glass = 1.49;  ///< acrylic
  double index_water = 1.335;
};

/// A half-line in the water, camera frame.
struct WaterRay {
  Vec3 origin_C = Vec3::Zero();      ///< on the outer face, m
  Vec3 direction_C = Vec3::UnitZ();  ///< unit
};

/// Direction after passing into a medium, for unit `direction` and unit `normal` on the far side of the
/// surface (Snell's law in vector form). `index_ratio` is that of the near medium over that of the far one.
/// Nothing at total reflection.
std::optional<Vec3> refract(const Vec3& direction, const Vec3& normal, double index_ratio);

/// Where a ray that leaves the centre of projection in air goes in the water. Nothing where it never passes.
std::optional<WaterRay> throughPort(const FlatPort& port, const Vec3& direction_air_C);

/// The camera in air that, behind the port, sees about the same as `in_water` does: focal lengths divided by
/// the water's refractive index, no distortion of its own.
CameraCalibration airCameraFor(const CameraCalibration& in_water, const FlatPort& port);

/// What a calibration in water would find for a camera behind a port.
struct PortFit {
  CameraCalibration calibration;  ///< radial-tangential, four coefficients; camera pose moved along the axis
  double rms_px = 0.0;            ///< what the model cannot express
};

/// Least-squares fit of a radial-tangential camera to points seen through the port at `near_m` to `far_m`:
/// focal lengths, principal point, k1 k2 p1 p2 and a shift of the centre along the optical axis, as a
/// calibration with a target at these distances gives. Gauss-Newton.
PortFit fitRadialTangential(const CameraCalibration& in_air, const FlatPort& port, double near_m = 0.6,
                            double far_m = 4.0);

}  // namespace lodeline
