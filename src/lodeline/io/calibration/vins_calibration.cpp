#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/calibration_translation.h"

namespace lodeline {
namespace {

constexpr double kAssumedRate_hz = 200.0;
/// Minimum densities of small IMUs (m/s^2/sqrt(Hz), rad/s/sqrt(Hz)): a tenth of an ADIS16448's.
constexpr double kLeastAccelerometerDensity = 2e-4;
constexpr double kLeastGyroscopeDensity = 1.7e-5;

double positiveFigure(const std::string& key, CalibrationMap* map) {
  const double value = map->number(key);
  if (!(value > 0.0))
    throw InputError(fmt::format("{} is {:g}; it must be positive", map->atLine(key), value));
  return value;
}

/// Keys of a camera model in VINS's files (camodocal), and the names of the same model in Lodeline.
struct VinsModel {
  std::string_view name, model, without_distortion;
  std::vector<std::string> pinhole, coefficients;
  bool is_fisheye = false;  ///< the coefficients are among the projection parameters
};

const VinsModel kVinsModels[] = {
    {"PINHOLE", "radial-tangential", "none", {"fx", "fy", "cx", "cy"}, {"k1", "k2", "p1", "p2"}},
    {"MEI", "unified", "unified", {"gamma1", "gamma2", "u0", "v0"}, {"k1", "k2", "p1", "p2"}},
    {"KANNALA_BRANDT",
     "equidistant",
     "equidistant",
     {"mu", "mv", "u0", "v0"},
     {"k2", "k3", "k4", "k5"},
     true},
};

/// Translates the noise. For every reading, VINS adds acc_n^2 dt^2 to the variance of the velocity and
/// acc_w^2 dt^2 to that of the bias. acc_n is therefore the standard deviation of a reading.
YAML::Node vinsImu(CalibrationMap* root, Diagnostics* diagnostics) {
  const double acc_n = positiveFigure("acc_n", root), gyr_n = positiveFigure("gyr_n", root);
  const double acc_w = positiveFigure("acc_w", root), gyr_w = positiveFigure("gyr_w", root);
  const double to_density = 1.0 / std::sqrt(kAssumedRate_hz);
  const bool are_densities =
      acc_n * to_density < kLeastAccelerometerDensity || gyr_n * to_density < kLeastGyroscopeDensity;
  const double factor = are_densities ? 1.0 : to_density;
  diagnostics->report(
      Severity::Warning, "calibration_assumed",
      are_densities
          ? fmt::format(
                "{}: acc_n {:g} and gyr_n {:g} are too small for deviations of single readings, as VINS "
                "uses them; taken as noise densities",
                root->file().string(), acc_n, gyr_n)
          : fmt::format(
                "{}: VINS states noise per reading (acc_n {:g}, gyr_n {:g}) without a rate; taken for "
                "{:g} Hz. Better figures: a datasheet's, or `lodeline allan`",
                root->file().string(), acc_n, gyr_n, kAssumedRate_hz));
  YAML::Node imu;
  if (root->has("imu_topic")) imu["topic"] = root->text("imu_topic");
  imu["gyroscope_noise_density"] = fmt::format("{}", gyr_n * factor);
  imu["gyroscope_random_walk"] = fmt::format("{}", gyr_w * factor);
  imu["accelerometer_noise_density"] = fmt::format("{}", acc_n * factor);
  imu["accelerometer_random_walk"] = fmt::format("{}", acc_w * factor);
  return imu;
}

/// Reads VINS-Mono's two extrinsics keys, which replace a single one.
YAML::Node monoExtrinsics(CalibrationMap* root) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = root->matrix3("extrinsicRotation");
  matrix.topRightCorner<3, 1>() = root->vector3("extrinsicTranslation");
  return transformNode(Rigid3::fromMatrix(matrix, root->atLine("extrinsicRotation").c_str()));
}

YAML::Node readCameraFile(const std::string& key, CalibrationMap* root) {
  const std::filesystem::path file = root->file().parent_path() / root->text(key);
  if (!std::filesystem::is_regular_file(file)) {
    throw InputError(
        fmt::format("{} names {}, which is missing; put it beside", root->atLine(key), file.string()));
  }
  CalibrationMap camera(loadYamlFile(file), file, "");
  return translateVinsCamera(&camera);
}

YAML::Node vinsCamera(int i, CalibrationMap* root) {
  const std::string extrinsics = fmt::format("body_T_cam{}", i);
  const std::string file = fmt::format("cam{}_calib", i);
  const bool is_mono = !root->has(extrinsics) && root->has("extrinsicRotation");
  YAML::Node camera = root->has(file) ? readCameraFile(file, root) : translateVinsCamera(root);
  camera["T_BS"] = is_mono ? monoExtrinsics(root) : numbersAsWritten(extrinsics, 16, root);
  for (const std::string& topic : {fmt::format("image{}_topic", i), std::string("image_topic")}) {
    if (root->has(topic) && !camera["topic"].IsDefined()) camera["topic"] = root->text(topic);
  }
  if (root->has("td")) camera["timeshift_cam_imu"] = root->text("td");
  return camera;
}

}  // namespace

YAML::Node translateVinsCamera(CalibrationMap* root) {
  YAML::Node camera;
  camera["resolution"].push_back(root->text("image_width"));
  camera["resolution"].push_back(root->text("image_height"));
  const std::string type = root->text("model_type");
  const auto keys = std::find_if(std::begin(kVinsModels), std::end(kVinsModels),
                                 [&](const VinsModel& model) { return model.name == type; });
  if (keys == std::end(kVinsModels)) {
    throw InputError(
        fmt::format("{} is '{}', a camera model that Lodeline does not have; calibrate with PINHOLE, MEI or "
                    "KANNALA_BRANDT",
                    root->atLine("model_type"), type));
  }
  std::optional<CalibrationMap> projection = root->section("projection_parameters");
  if (!projection) throw InputError(root->at("projection_parameters") + " is missing");
  if (std::optional<CalibrationMap> mirror = root->section("mirror_parameters"))
    camera["intrinsics"] = numbersUnder({"xi"}, &*mirror);
  for (const YAML::Node& number : numbersUnder(keys->pinhole, &*projection))
    camera["intrinsics"].push_back(number.Scalar());
  std::optional<CalibrationMap> distortion =
      keys->is_fisheye ? projection : root->section("distortion_parameters");
  setCameraModel(*findCameraModel(distortion ? keys->model : keys->without_distortion), &camera);
  if (distortion) camera["distortion_coefficients"] = numbersUnder(keys->coefficients, &*distortion);
  return camera;
}

TranslatedSections translateVins(CalibrationMap* root, Diagnostics* diagnostics) {
  if (root->numberOr("estimate_extrinsic", 0.0) == 2.0) {
    throw InputError(
        root->atLine("estimate_extrinsic") +
        " is 2: the file does not know how the camera is mounted; give body_T_cam0 and set it to 0");
  }
  TranslatedSections sections;
  const int cameras = static_cast<int>(root->numberOr("num_of_cam", root->has("body_T_cam1") ? 2.0 : 1.0));
  for (int i = 0; i < cameras; ++i) sections[fmt::format("cam{}", i)] = vinsCamera(i, root);
  if (root->numberOr("imu", 1.0) != 0.0) sections["imu0"] = vinsImu(root, diagnostics);
  return sections;
}

}  // namespace lodeline
