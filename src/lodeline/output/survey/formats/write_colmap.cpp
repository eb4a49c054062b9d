#include <fmt/format.h>

#include <iterator>

#include "lodeline/cameras/fit_camera.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/output/survey/formats/write_formats.h"

namespace lodeline {
namespace {

/// COLMAP's form of a camera with at least its number of parameters; null where COLMAP has none, as for a
/// camera behind a port.
const ColmapForm* colmapForm(const CameraCalibration& camera) {
  if (camera.port) return nullptr;
  for (const ColmapForm& form : cameraModel(camera).colmap) {
    if (form.parameters >= camera.distortion.size()) return &form;
  }
  return nullptr;
}

/// COLMAP's name and parameters of a camera. Its pixel centres are at half-integers, ours at integers.
std::string cameraLine(const CameraCalibration& camera, const ColmapForm& form) {
  std::vector<double> parameters = {camera.fx_px, camera.fy_px, camera.cx_px + 0.5, camera.cy_px + 0.5};
  parameters.insert(parameters.end(), camera.distortion.begin(), camera.distortion.end());
  parameters.resize(4 + form.parameters, 0.0);
  std::string text = fmt::format("{} {} {}", form.name, camera.width_px, camera.height_px);
  for (double parameter : parameters) text += fmt::format(" {:.12g}", parameter);
  return text;
}

/// The line of a camera. A comment precedes it where COLMAP lacks the model: a fitted equidistant camera
/// takes its place.
std::string cameraLines(size_t id, const CameraCalibration& camera) {
  if (const ColmapForm* form = colmapForm(camera))
    return fmt::format("{} {}\n", id, cameraLine(camera, *form));
  const CameraFit fit = convertedCamera(camera, *findCameraModel("equidistant"));
  return fmt::format(
      "# {}: COLMAP has no {} model{}; the fisheye model below deviates by {:.2g} px rms\n{} {}\n",
      camera.name, camera.model, camera.port ? " behind a port" : "", fit.rms_px, id,
      cameraLine(fit.calibration, *colmapForm(fit.calibration)));
}

}  // namespace

ColmapModel colmapModel(const DiveMap& map, const std::vector<CameraCalibration>& cameras,
                        const std::vector<ColmapImage>& images) {
  ColmapModel model;
  model.cameras = "# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n";
  for (size_t i = 0; i < cameras.size(); ++i) {
    model.cameras += cameraLines(i + 1, cameras[i]);
  }
  model.images = "# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME; then POINTS2D[] (none)\n";
  size_t id = 0;
  for (const ColmapImage& image : images) {
    const Rigid3 camera_from_map =
        (map.trajectory.poses.at(image.pose).world_from_body * cameras.at(image.camera).body_from_camera)
            .inverse();
    const Quat q = so3::canonical(camera_from_map.rotation);
    const Vec3& t = camera_from_map.translation;
    fmt::format_to(std::back_inserter(model.images),
                   "{} {:.12g} {:.12g} {:.12g} {:.12g} {:.9f} {:.9f} {:.9f} {} {}\n\n", ++id, q.w(), q.x(),
                   q.y(), q.z(), t.x(), t.y(), t.z(), image.camera + 1, image.name);
  }
  model.points3D = "# POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] (none); metres " + map.north.axes + "\n";
  id = 0;
  for (const MapLandmark& landmark : map.landmarks) {
    fmt::format_to(std::back_inserter(model.points3D), "{} {:.6f} {:.6f} {:.6f} 170 160 145 0\n", ++id,
                   landmark.position.x(), landmark.position.y(), landmark.position.z());
  }
  return model;
}

}  // namespace lodeline
