#include "lodeline/io/calibration/camera_keys.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "lodeline/cameras/camera.h"
#include "lodeline/cameras/camera_file_keys.h"
#include "lodeline/diagnostics.h"

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

const CameraModel& readModel(CalibrationMap* map) {
  const bool has_projection = map->has("camera_model");
  const std::string projection = has_projection ? map->text("camera_model") : "pinhole";
  const std::string distortion = map->text("distortion_model");
  const CameraModel* model = findCameraModel(projection, distortion);
  if (model != nullptr) return *model;
  throw InputError(fmt::format(
      "{} is '{}'{}; supported are, with their distortion models, {}: calibrate with one of these",
      map->at("distortion_model"), distortion,
      has_projection ? fmt::format(" and camera_model '{}'", projection) : "", cameraFileModels()));
}

std::vector<double> readDistortion(const std::string& key, const CameraModel& model, CalibrationMap* map) {
  const std::string name = map->text("distortion_model");
  if (name == "none" || name.empty()) {
    map->ignore({key});
    return {};
  }
  std::vector<double> values = map->numbers(key);
  const size_t n = values.size();
  const bool finite = std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
  if (!model.takes(model.before_focal_lengths + n) || !finite) {
    throw InputError(fmt::format("{} has {} numbers; {} needs {} finite ones", map->at(key), n, name,
                                 model.countWords(model.before_focal_lengths)));
  }
  return values;
}

/// Rejects values that no lens and sensor can have. The usual causes are other units, or the calibration of
/// another image size.
void checkPlausible(const CalibrationMap& map, const CameraCalibration& camera) {
  const double width = camera.width_px, height = camera.height_px;
  const Vec2 focal_px = makeCamera(camera)->focalLengthsOnAxis_px();
  const double focal_share = focal_px.x() / width;
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
  if (focal_share < kShortest || focal_share > kLongest || focal_px.y() < kShortest * height ||
      focal_px.y() > kLongest * width) {
    throw InputError(
        fmt::format("{}: a focal length of {:g}, {:g} px cannot be for an image {} px wide; it must be in "
                    "pixels of that size",
                    map.at("intrinsics"), focal_px.x(), focal_px.y(), width));
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
      "of the coefficients right ({}: {})?",
      map.at(key), 100.0 * share, calibration.model, fmt::join(camera->model().parameters, ", ")));
}

// Readout of a rolling shutter whose file does not state it, and standard deviations of what a file states.
constexpr double kUsualReadout_s = 0.0165, kUsualReadoutSigma_s = 0.010;
constexpr double kReadoutSigma = 0.25, kLineDelaySigma = 0.02;
constexpr double kLongestLineDelay_s = 1e-3;

double nonNegative(const std::string& key, CalibrationMap* map) {
  const double value = map->number(key);
  if (std::isfinite(value) && value >= 0.0) return value;
  throw InputError(fmt::format("{} is {:g}; it must be 0 or more", map->atLine(key), value));
}

bool isRolling(CalibrationMap* map) {
  if (!map->has("shutter")) return false;
  const std::string shutter = map->text("shutter");
  if (shutter == "rolling") return true;
  if (shutter == "global") return false;
  throw InputError(fmt::format("{} is '{}'; it must be global or rolling", map->atLine("shutter"), shutter));
}

}  // namespace

void readCameraModel(const std::string& coefficients_key, CalibrationMap* map, CameraCalibration* camera) {
  const std::vector<double> resolution = numbersOfCount("resolution", 2, "width, height in px", map);
  camera->width_px = static_cast<int>(std::clamp(resolution[0], 0.0, 1e6));
  camera->height_px = static_cast<int>(std::clamp(resolution[1], 0.0, 1e6));
  if (camera->width_px < 1 || camera->height_px < 1) {
    throw InputError(map->at("resolution") + " must be two positive numbers");
  }
  const CameraModel& model = readModel(map);
  CameraFileKeys keys;
  keys.intrinsics = numbersOfCount("intrinsics", model.before_focal_lengths + 4,
                                   (intrinsicsNames(model) + " in px").c_str(), map);
  keys.distortion_coefficients = readDistortion(coefficients_key, model, map);
  setFromFileKeys(model, keys, camera);
  if (!(camera->fx_px > 0.0 && camera->fy_px > 0.0)) {
    throw InputError(map->at("intrinsics") + ": the focal lengths must be positive");
  }
  const std::string fault = model.fault ? model.fault(camera->distortion) : "";
  if (!fault.empty()) {
    throw InputError(fmt::format(
        "{}: {}", map->at(model.before_focal_lengths > 0 ? "intrinsics" : coefficients_key), fault));
  }
  camera->port = readPort(map);
  readShutter(map, camera);
  checkPlausible(*map, *camera);
  checkDistortion(coefficients_key, *map, *camera);
}

void readShutter(CalibrationMap* map, CameraCalibration* camera) {
  const bool rolling = isRolling(map);
  if (map->has("line_delay_s")) {
    camera->line_delay_s = nonNegative("line_delay_s", map);
    camera->line_delay_sigma_s = kLineDelaySigma * camera->line_delay_s;
  } else if (map->has("line_delay")) {
    camera->line_delay_s = 1e-9 * nonNegative("line_delay", map);
    camera->line_delay_sigma_s = kLineDelaySigma * camera->line_delay_s;
  } else if (map->has("readout_s")) {
    camera->line_delay_s = nonNegative("readout_s", map) / camera->height_px;
    camera->line_delay_sigma_s = kReadoutSigma * camera->line_delay_s;
  } else if (rolling) {
    camera->line_delay_s = kUsualReadout_s / camera->height_px;
    camera->line_delay_sigma_s = kUsualReadoutSigma_s / camera->height_px;
  }
  if (map->has("line_delay_sigma_s")) camera->line_delay_sigma_s = nonNegative("line_delay_sigma_s", map);
  if (camera->line_delay_s > kLongestLineDelay_s || camera->line_delay_sigma_s > kLongestLineDelay_s) {
    throw InputError(
        fmt::format("{}: a line delay of {:g} s is longer than any shutter's; `line_delay_s` is in "
                    "seconds and `line_delay` in nanoseconds",
                    map->at("shutter"), camera->line_delay_s));
  }
}

std::string shutterText(const CameraCalibration& camera, const std::string& indent) {
  if (!camera.hasRollingShutter()) return "";
  return fmt::format("{0}line_delay_s: {1}\n{0}line_delay_sigma_s: {2}\n", indent, camera.line_delay_s,
                     camera.line_delay_sigma_s);
}

}  // namespace lodeline
