#include <fmt/format.h>

#include <cmath>

#include "lodeline/cameras/camera.h"
#include "lodeline/cameras/equidistant_camera.h"
#include "lodeline/cameras/radial_tangential_camera.h"
#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

void checkCount(const CameraCalibration& c) {
  const size_t n = c.distortion.size();
  switch (c.distortion_model) {
    case DistortionModel::None:
      if (n == 0) return;
      throw InputError(fmt::format(
          "camera '{}': {} distortion coefficients but no distortion model; name the model", c.name, n));
    case DistortionModel::RadialTangential:
      if (n == 4 || n == 5 || n == 8) return;
      throw InputError(fmt::format(
          "camera '{}': radial-tangential distortion takes 4, 5 or 8 coefficients, found {}", c.name, n));
    case DistortionModel::Equidistant:
      if (n == 4) return;
      throw InputError(
          fmt::format("camera '{}': equidistant distortion takes 4 coefficients, found {}", c.name, n));
  }
}

void check(const CameraCalibration& c) {
  if (c.width_px <= 0 || c.height_px <= 0) {
    throw InputError(
        fmt::format("camera '{}': resolution {} x {} px must be positive", c.name, c.width_px, c.height_px));
  }
  for (const double focal_length_px : {c.fx_px, c.fy_px}) {
    if (std::isfinite(focal_length_px) && focal_length_px > 0.0) continue;
    throw InputError(
        fmt::format("camera '{}': focal length {} px must be positive", c.name, focal_length_px));
  }
  for (const double centre_px : {c.cx_px, c.cy_px}) {
    if (std::isfinite(centre_px)) continue;
    throw InputError(fmt::format("camera '{}': principal point {} px is no number", c.name, centre_px));
  }
  checkCount(c);
  for (const double coefficient : c.distortion) {
    if (std::isfinite(coefficient)) continue;
    throw InputError(fmt::format("camera '{}': distortion coefficient {} is no number", c.name, coefficient));
  }
}

}  // namespace

std::shared_ptr<const Camera> makeCamera(const CameraCalibration& calibration) {
  check(calibration);
  if (calibration.distortion_model == DistortionModel::Equidistant) {
    return std::make_shared<EquidistantCamera>(calibration);
  }
  return std::make_shared<RadialTangentialCamera>(calibration);
}

}  // namespace lodeline
