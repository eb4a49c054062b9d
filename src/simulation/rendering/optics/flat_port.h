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

/// The camera in air that, behind the port, has approximately the image of `in_water`: focal lengths divided
/// by the water's refractive index, no distortion.
CameraCalibration airCameraFor(const CameraCalibration& in_water, const FlatPort& port);

/// Calibration in water of a camera behind a port.
struct PortFit {
  CameraCalibration calibration;  ///< radial-tangential, four coefficients; camera pose moved along the axis
  double rms_px = 0.0;            ///< residual that the model cannot represent
};

/// Least-squares fit (Gauss-Newton) of a radial-tangential camera to points seen through the port at `near_m`
/// to `far_m`. The parameters are focal lengths, principal point, k1 k2 p1 p2 and a shift of the centre along
/// the optical axis, as in a calibration with a target at these distances.
PortFit fitRadialTangential(const CameraCalibration& in_air, const FlatPort& port, double near_m = 0.6,
                            double far_m = 4.0);

}  // namespace lodeline
