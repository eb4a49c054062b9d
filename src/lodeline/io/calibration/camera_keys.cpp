#include "lodeline/io/calibration/camera_keys.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "lodeline/cameras/camera.h"
#include "lodeline/util/error.h"

namespace lodeline {
namespace {

std::vector<double> numbersOfCount(const std::string& key, size_t count, const char* what,
                                   CalibrationMap* map) {
  std::vector<double> values = map->numbers(key);
  const bool finite = std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
  if (values.size() != count || !finite) {
    throw InputError(fmt::format("{} must be {} finite numbers ({}), not [{}]", map->at(key), count, what,
                                 fmt::join(values, ", ")));
  }
  return values;
}

DistortionModel readDistortionModel(CalibrationMap* map) {
  const std::string name = map->text("distortion_model");
  if (name == "radial-tangential" || name == "radtan" || name == "plumb_bob" ||
      name == "rational_polynomial") {
    return "radial-tangential";
  }
  if (name == "equidistant" || name == "equi") return "equidistant";
  if (name == "none" || name.empty()) return "none";
  throw InputError(
      fmt::format("{} is '{}'; supported are radial-tangential (radtan), equidistant and none: calibrate "
                  "with one of these",
                  map->at("distortion_model"), name));
}

std::vector<double> readDistortion(const std::string& key, DistortionModel model, CalibrationMap* map) {
  if (model == "none") {
    map->ignore({key});
    return {};
  }
  std::vector<double> values = map->numbers(key);
  const size_t n = values.size();
  const bool fits = model == "equidistant" ? n == 4 : n == 4 || n == 5 || n == 8;
  const bool finite = std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
  if (!fits || !finite) {
    throw InputError(fmt::format("{} has {} numbers; {} needs {} finite ones", map->at(key), n,
                                 map->text("distortion_model"),
                                 model == "equidistant" ? "4" : "4, 5 or 8"));
  }
  return values;
}

/// Rejects values that no lens and sensor can have. The usual causes are other units, or the calibration of
/// another image size.
void checkPlausible(const CalibrationMap& map, const CameraCalibration& camera) {
  const double width = camera.width_px, height = camera.height_px;
  const double focal_share = camera.fx_px / width;
  const bool is_relative = std::max({camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px}) < 10.0 &&
                           std::min(width, height) > 20.0;
  if (is_relative) {
    throw InputError(fmt::format(
        "{}: [{:g}, {:g}, {:g}, {:g}] look like shares of the image's size, but pixels are due; multiply fx "
        "and "
        "cx by {}, fy and cy by {}",
        map.at("intrinsics"), camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px, width, height));
  }
  constexpr double kShortest = 0.1, kLongest = 20.0;  // in image widths; real lenses have 0.25 to 5
  if (focal_share < kShortest || focal_share > kLongest || camera.fy_px < kShortest * height ||
      camera.fy_px > kLongest * width) {
    throw InputError(
        fmt::format("{}: a focal length of {:g}, {:g} px cannot be for an image {} px wide; it must be in "
                    "pixels of that size",
                    map.at("intrinsics"), camera.fx_px, camera.fy_px, width));
  }
  if (camera.cx_px < 0.0 || camera.cx_px > width || camera.cy_px < 0.0 || camera.cy_px > height) {
    throw InputError(fmt::format(
        "{}: the principal point ({:g}, {:g}) px lies outside of the image of {} x {} px; is this the "
        "calibration of another image size, or are intrinsics not in the order fx, fy, cx, cy?",
        map.at("intrinsics"), camera.cx_px, camera.cy_px, width, height));
  }
}

/// Rejects a distortion for which less than half of the image has viewing rays.
void checkDistortion(const std::string& key, const CalibrationMap& map,
                     const CameraCalibration& calibration) {
  const std::shared_ptr<const Camera> camera = makeCamera(calibration);
  constexpr int kSteps = 8;
  int seen = 0;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      const Vec2 pixel(i * (calibration.width_px - 1.0) / kSteps, j * (calibration.height_px - 1.0) / kSteps);
      if (camera->unproject(pixel)) ++seen;
    }
  }
  const double share = seen / ((kSteps + 1.0) * (kSteps + 1.0));
  if (share >= 0.5) return;
  throw InputError(fmt::format(
      "{}: under this distortion only {:.0f} % of the image have a viewing ray; are model and order "
      "of the coefficients right (radtan: k1, k2, p1, p2; equidistant: k1, k2, k3, k4)?",
      map.at(key), 100.0 * share));
}

}  // namespace

void readPinhole(const std::string& coefficients_key, CalibrationMap* map, CameraCalibration* camera) {
  if (map->has("camera_model") && map->text("camera_model") != "pinhole") {
    throw InputError(fmt::format("{} is '{}'; only pinhole is supported: calibrate again with that model",
                                 map->at("camera_model"), map->text("camera_model")));
  }
  const std::vector<double> resolution = numbersOfCount("resolution", 2, "width, height in px", map);
  camera->width_px = static_cast<int>(std::clamp(resolution[0], 0.0, 1e6));
  camera->height_px = static_cast<int>(std::clamp(resolution[1], 0.0, 1e6));
  const std::vector<double> intrinsics = numbersOfCount("intrinsics", 4, "fx, fy, cx, cy in px", map);
  camera->fx_px = intrinsics[0];
  camera->fy_px = intrinsics[1];
  camera->cx_px = intrinsics[2];
  camera->cy_px = intrinsics[3];
  if (camera->width_px < 1 || camera->height_px < 1) {
    throw InputError(map->at("resolution") + " must be two positive numbers");
  }
  if (!(camera->fx_px > 0.0 && camera->fy_px > 0.0)) {
    throw InputError(map->at("intrinsics") + ": the focal lengths must be positive");
  }
  camera->model = readDistortionModel(map);
  camera->distortion = readDistortion(coefficients_key, camera->model, map);
  checkPlausible(*map, *camera);
  checkDistortion(coefficients_key, *map, *camera);
}

}  // namespace lodeline
