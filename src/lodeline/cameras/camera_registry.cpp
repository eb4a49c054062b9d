#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "lodeline/cameras/camera_model.h"
#include "lodeline/cameras/port_camera.h"
#include "lodeline/diagnostics.h"

// The registration: one line for each model. NAME_camera.cpp defines the function.
#define LODELINE_CAMERA_MODELS(MODEL) \
  MODEL(pinholeModel)                 \
  MODEL(radialTangentialModel)        \
  MODEL(equidistantModel)             \
  MODEL(doubleSphereModel)            \
  MODEL(unifiedModel)                 \
  MODEL(extendedUnifiedModel)         \
  MODEL(fieldOfViewModel)

namespace lodeline {

#define LODELINE_DECLARE(FUNCTION) CameraModel FUNCTION();
LODELINE_CAMERA_MODELS(LODELINE_DECLARE)
#undef LODELINE_DECLARE

namespace {

bool contains(const std::vector<std::string_view>& names, std::string_view name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

void checkCount(const CameraModel& model, const CameraCalibration& c) {
  const size_t n = c.distortion.size();
  if (model.takes(n)) return;
  if (model.parameters.empty()) {
    throw InputError(fmt::format(
        "camera '{}': {} distortion coefficients but no distortion model; name the model", c.name, n));
  }
  throw InputError(fmt::format("camera '{}': the {} model takes {} parameters ({}), found {}", c.name,
                               model.name, model.countWords(), fmt::join(model.parameters, ", "), n));
}

void check(const CameraModel& model, const CameraCalibration& c) {
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
  checkCount(model, c);
  for (const double coefficient : c.distortion) {
    if (std::isfinite(coefficient)) continue;
    throw InputError(fmt::format("camera '{}': distortion coefficient {} is no number", c.name, coefficient));
  }
  const std::string fault = model.fault ? model.fault(c.distortion) : "";
  if (!fault.empty()) throw InputError(fmt::format("camera '{}': {}", c.name, fault));
}

}  // namespace

bool CameraModel::takes(size_t count) const {
  return std::find(counts.begin(), counts.end(), count) != counts.end();
}

std::string CameraModel::countWords(size_t without) const {
  std::string words;
  for (size_t i = 0; i < counts.size(); ++i) {
    if (i > 0) words += i + 1 == counts.size() ? " or " : ", ";
    words += std::to_string(counts[i] - without);
  }
  return words;
}

const std::vector<CameraModel>& cameraModels() {
#define LODELINE_CALL(FUNCTION) FUNCTION(),
  static const std::vector<CameraModel> models = {LODELINE_CAMERA_MODELS(LODELINE_CALL)};
#undef LODELINE_CALL
  return models;
}

const CameraModel* findCameraModel(std::string_view name) {
  for (const CameraModel& model : cameraModels()) {
    if (model.name == name || contains(model.aliases, name)) return &model;
  }
  return nullptr;
}

const CameraModel* findCameraModel(std::string_view projection, std::string_view distortion) {
  for (const CameraModel& model : cameraModels()) {
    if (contains(model.projections, projection) && contains(model.distortions, distortion)) return &model;
  }
  return nullptr;
}

const CameraModel& cameraModel(const CameraCalibration& calibration) {
  for (const CameraModel& model : cameraModels()) {
    if (model.name == calibration.model) return model;
  }
  throw InputError(fmt::format("camera '{}': there is no camera model '{}'; there are {}", calibration.name,
                               calibration.model, cameraModelNames()));
}

std::string cameraModelNames() {
  std::vector<std::string_view> names;
  for (const CameraModel& model : cameraModels()) names.push_back(model.name);
  return fmt::format("{}", fmt::join(names, ", "));
}

double focalLengthOnAxis_px(const CameraCalibration& calibration) {
  const bool is_calibrated = calibration.width_px > 0 && calibration.fx_px != 0.0;
  return is_calibrated ? makeCamera(calibration)->focalLengthsOnAxis_px().x() : 0.0;
}

Camera::Camera(const CameraCalibration& calibration)
    : calibration_(calibration), model_(&cameraModel(calibration)) {}

std::optional<ViewRay> Camera::viewRay(const Vec2& pixel) const {
  const std::optional<Vec3> direction_C = unproject(pixel);
  if (!direction_C) return std::nullopt;
  return ViewRay{Vec3::Zero(), *direction_C};
}

std::optional<Vec2> Camera::projectHomogeneous(const Vec3& point_C, double) const { return project(point_C); }

Vec2 Camera::focalLengthsOnAxis_px() const {
  Mat23 pixel_by_point;
  project(Vec3::UnitZ(), &pixel_by_point);
  return Vec2(pixel_by_point(0, 0), pixel_by_point(1, 1));
}

std::shared_ptr<const Camera> makeCamera(const CameraCalibration& calibration) {
  const CameraModel& model = cameraModel(calibration);
  check(model, calibration);
  if (!calibration.port) return model.make(calibration);
  const std::string fault = portFault(*calibration.port);
  if (!fault.empty()) throw InputError(fmt::format("camera '{}': {}", calibration.name, fault));
  CameraCalibration lens = calibration;
  lens.port.reset();
  return makeRefractiveCamera(calibration, model.make(lens));
}

}  // namespace lodeline
