#include "lodeline/data/camera_keys.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "lodeline/base/error.h"

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
    return DistortionModel::RadialTangential;
  }
  if (name == "equidistant" || name == "equi") return DistortionModel::Equidistant;
  if (name == "none" || name.empty()) return DistortionModel::None;
  throw InputError(
      fmt::format("{} is '{}'; supported are radial-tangential (radtan), equidistant and none: calibrate "
                  "with one of these",
                  map->at("distortion_model"), name));
}

std::vector<double> readDistortion(const std::string& key, DistortionModel model, CalibrationMap* map) {
  if (model == DistortionModel::None) {
    map->ignore({key});
    return {};
  }
  std::vector<double> values = map->numbers(key);
  const size_t n = values.size();
  const bool fits = model == DistortionModel::Equidistant ? n == 4 : n == 4 || n == 5 || n == 8;
  const bool finite = std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
  if (!fits || !finite) {
    throw InputError(fmt::format("{} has {} numbers; {} needs {} finite ones", map->at(key), n,
                                 map->text("distortion_model"),
                                 model == DistortionModel::Equidistant ? "4" : "4, 5 or 8"));
  }
  return values;
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
  camera->distortion_model = readDistortionModel(map);
  camera->distortion = readDistortion(coefficients_key, camera->distortion_model, map);
}

}  // namespace lodeline
