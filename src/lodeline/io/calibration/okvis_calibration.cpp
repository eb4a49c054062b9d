#include <fmt/core.h>

#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/calibration_translation.h"

namespace lodeline {
namespace {

YAML::Node okvisCamera(CalibrationMap* map) {
  YAML::Node camera;
  camera["T_BS"] = numbersAsWritten("T_SC", 16, map);
  camera["resolution"] = numbersAsWritten("image_dimension", 2, map);
  camera["intrinsics"] = numbersAsWritten("focal_length", 2, map);
  for (const YAML::Node& number : numbersAsWritten("principal_point", 2, map)) {
    camera["intrinsics"].push_back(number.Scalar());
  }
  const std::string theirs = map->text("distortion_type");
  const CameraModel* model = findCameraModel(theirs);
  if (model == nullptr || model->before_focal_lengths > 0) {
    throw InputError(
        fmt::format("{} is '{}', a camera model that Lodeline does not have; calibrate with "
                    "radialtangential or equidistant",
                    map->atLine("distortion_type"), theirs));
  }
  setCameraModel(*model, &camera);
  if (!model->parameters.empty()) {
    const size_t count = map->numbers("distortion_coefficients").size();
    camera["distortion_coefficients"] = numbersAsWritten("distortion_coefficients", count, map);
  }
  return camera;
}

/// Text of a number in a section, under any of the names used in the versions of OKVIS.
std::optional<std::string> textIn(std::initializer_list<std::pair<const char*, const char*>> places,
                                  CalibrationMap* root) {
  for (const auto& [section, key] : places) {
    std::optional<CalibrationMap> map = *section == '\0' ? std::optional(*root) : root->section(section);
    if (!map || !map->has(key)) continue;
    map->number(key);
    return map->text(key);
  }
  return std::nullopt;
}

YAML::Node okvisImu(CalibrationMap* map) {
  YAML::Node imu;
  for (const auto& [ours, theirs] :
       {std::pair("gyroscope_noise_density", "sigma_g_c"), std::pair("gyroscope_random_walk", "sigma_gw_c"),
        std::pair("accelerometer_noise_density", "sigma_a_c"),
        std::pair("accelerometer_random_walk", "sigma_aw_c")}) {
    map->number(theirs);
    imu[ours] = map->text(theirs);
  }
  if (map->has("imu_rate")) imu["rate_hz"] = map->text("imu_rate");
  return imu;
}

}  // namespace

TranslatedSections translateOkvis(CalibrationMap* root) {
  TranslatedSections sections;
  const YAML::Node cameras = root->node()["cameras"];
  // OKVIS subtracts the delay from image stamps, whereas Lodeline adds its offset.
  const std::optional<std::string> delay = textIn({{"camera_parameters", "image_delay"},
                                                   {"camera_params", "image_delay"},
                                                   {"", "image_delay"},
                                                   {"", "imageDelay"}},
                                                  root);
  const std::optional<std::string> rate = textIn({{"camera_params", "camera_rate"}}, root);
  for (size_t i = 0; i < cameras.size(); ++i) {
    CalibrationMap map(cameras[i], root->file(), fmt::format("cameras[{}]", i));
    YAML::Node camera = okvisCamera(&map);
    if (delay) camera["timeshift_cam_imu"] = fmt::format("{}", 0.0 - YAML::Node(*delay).as<double>());
    if (rate) camera["rate_hz"] = *rate;
    sections[fmt::format("cam{}", i)] = camera;
  }
  std::optional<CalibrationMap> imu = root->section("imu_parameters");
  if (!imu) imu = root->section("imu_params");
  if (imu) sections["imu0"] = okvisImu(&*imu);
  return sections;
}

}  // namespace lodeline
