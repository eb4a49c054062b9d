#pragma once

#include <vector>

#include "lodeline/cameras/camera_model.h"

namespace lodeline {

struct CameraFit {
  CameraCalibration calibration;
  double rms_px = 0.0;  ///< of the remaining distances between pixels
};

/// A unit ray of C and its pixel.
struct RayObservation {
  Vec3 ray_C;
  Vec2 pixel;
};

/// A grid of pixels over the image of a camera with their rays.
std::vector<RayObservation> imageObservations(const Camera& camera);

/// Least-squares parameters of a camera model for observations. `start` names the model and is the initial
/// value. Rays that `start` does not see have no part. Method: K. Levenberg, "A method for the solution of
/// certain non-linear problems in least squares", 1944. Throws InputError where `start` is no camera.
CameraFit fitCamera(const CameraCalibration& start, std::vector<RayObservation> observations);

/// The camera of another model with the least distances between the pixels. It has no port: behind a port, it
/// is the camera with the rays of Camera::unproject.
CameraFit convertedCamera(const CameraCalibration& calibration, const CameraModel& to);

}  // namespace lodeline
