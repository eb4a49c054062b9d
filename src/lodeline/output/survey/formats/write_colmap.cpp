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

/// Its pixel centres are at half-integers, ours at integers.
ColmapCamera inForm(const CameraCalibration& camera, const ColmapForm& form) {
  ColmapCamera result{std::string(form.name), camera.width_px, camera.height_px, {}, ""};
  result.parameters = {camera.fx_px, camera.fy_px, camera.cx_px + 0.5, camera.cy_px + 0.5};
  result.parameters.insert(result.parameters.end(), camera.distortion.begin(), camera.distortion.end());
  result.parameters.resize(4 + form.parameters, 0.0);
  return result;
}

std::string cameraLine(size_t id, const ColmapCamera& camera) {
  std::string text = camera.remark.empty() ? "" : "# " + camera.remark + "\n";
  text += fmt::format("{} {} {} {}", id, camera.model, camera.width_px, camera.height_px);
  for (double parameter : camera.parameters) text += fmt::format(" {:.12g}", parameter);
  return text + "\n";
}

}  // namespace

ColmapCamera colmapCamera(const CameraCalibration& camera) {
  if (const ColmapForm* form = colmapForm(camera)) return inForm(camera, *form);
  const CameraFit fit = convertedCamera(camera, *findCameraModel("equidistant"));
  ColmapCamera result = inForm(fit.calibration, *colmapForm(fit.calibration));
  result.remark =
      fmt::format("{}: COLMAP has no {} model{}; the fisheye model below deviates by {:.2g} px rms",
                  camera.name, camera.model, camera.port ? " behind a port" : "", fit.rms_px);
  return result;
}

Rigid3 colmapPose(const DiveMap& map, const std::vector<CameraCalibration>& cameras,
                  const ColmapImage& image) {
  const Rigid3& map_from_body = map.trajectory.poses.at(image.pose).world_from_body;
  return (map_from_body * cameras.at(image.camera).body_from_camera).inverse();
}

ColmapModel colmapModel(const DiveMap& map, const std::vector<CameraCalibration>& cameras,
                        const std::vector<ColmapImage>& images) {
  ColmapModel model;
  model.cameras = "# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n";
  for (size_t i = 0; i < cameras.size(); ++i) {
    model.cameras += cameraLine(i + 1, colmapCamera(cameras[i]));
  }
  model.images = "# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME; then POINTS2D[] (none)\n";
  size_t id = 0;
  for (const ColmapImage& image : images) {
    const Rigid3 camera_from_map = colmapPose(map, cameras, image);
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
