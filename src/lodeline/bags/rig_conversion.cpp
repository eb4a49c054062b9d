#include "lodeline/bags/rig_conversion.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "lodeline/base/error.h"
#include "lodeline/data/euroc_calibration.h"
#include "lodeline/data/kalibr_calibration.h"
#include "lodeline/data/recording_file.h"

namespace lodeline {
namespace {

/// Keys that Kalibr does not write; in a folder they stand in sensor.yaml.
constexpr std::array kBesideKalibr = {"rate_hz", "mask"};
/// Keys of a rig file that sensor.yaml does not know.
constexpr std::array kOfRigFile = {"topic", "rostopic", "water_density_kg_per_m3", "surface_pressure_Pa"};

template <typename Keys>
bool isAmong(const std::string& key, const Keys& keys) {
  return std::find(keys.begin(), keys.end(), key) != keys.end();
}

void writeYaml(const YAML::Node& node, const std::filesystem::path& file) {
  RecordingFile stream(file);
  stream.write(YAML::Dump(node) + "\n");
  stream.close();
}

/// Copies the mask that `node` names and makes the key name the copy.
void copyMask(const std::filesystem::path& from_folder, const std::filesystem::path& copy, YAML::Node* node) {
  if (!(*node)["mask"].IsDefined()) return;
  const std::filesystem::path mask = from_folder / (*node)["mask"].Scalar();
  std::filesystem::path target = copy;
  target += mask.extension();
  std::error_code error;
  std::filesystem::create_directories(target.parent_path(), error);
  std::filesystem::copy_file(mask, target, std::filesystem::copy_options::overwrite_existing, error);
  if (error) throw InputError(fmt::format("{}: cannot be copied to {}", mask.string(), target.string()));
  (*node)["mask"] = target.filename().string();
}

/// Only keys that the reader of the sensor knows: a rig file must not have others.
template <typename Read>
YAML::Node knownPart(const std::filesystem::path& file, const Read& read) {
  const YAML::Node node = loadYamlFile(file);
  CalibrationMap map(node, file, "");
  read(&map);
  YAML::Node known;
  for (const auto& entry : node) {
    if (map.isKnown(entry.first.Scalar())) known[entry.first.Scalar()] = entry.second;
  }
  return known;
}

YAML::Node cameraSection(const EurocLayout& layout, const KalibrFiles& kalibr, const std::string& name) {
  const std::filesystem::path yaml = layout.sensor(name) / "sensor.yaml";
  if (!kalibr.camchain) return knownPart(yaml, [&](CalibrationMap* map) { readEurocCamera(name, map); });
  YAML::Node section = loadYamlFile(*kalibr.camchain)[name];
  section.remove("rostopic");
  if (!std::filesystem::exists(yaml)) return section;
  const YAML::Node beside = loadYamlFile(yaml);
  for (const char* key : kBesideKalibr) {
    if (beside[key].IsDefined()) section[key] = beside[key];
  }
  return section;
}

YAML::Node imuSection(const EurocLayout& layout, const KalibrFiles& kalibr) {
  const std::filesystem::path yaml = layout.sensor("imu0") / "sensor.yaml";
  if (!kalibr.imu) return knownPart(yaml, [](CalibrationMap* map) { readEurocImu(map); });
  const YAML::Node root = loadYamlFile(*kalibr.imu);
  YAML::Node section = root["imu0"].IsDefined() ? root["imu0"] : root;
  if (!section["update_rate"].IsDefined()) {
    // Marks the section as Kalibr's; 0 stands for unknown.
    section["update_rate"] = std::filesystem::exists(yaml) ? loadYamlFile(yaml)["rate_hz"] : YAML::Node(0);
  }
  section.remove("rostopic");
  return section;
}

}  // namespace

void writeRigFile(const EurocLayout& layout, const std::map<std::string, std::string>& topics,
                  const std::filesystem::path& file) {
  const std::filesystem::path beside =
      std::filesystem::absolute(layout.mav0).lexically_normal().parent_path();
  const KalibrFiles kalibr = findKalibrFiles({beside, layout.mav0});
  YAML::Node root;
  for (size_t i = 0; i < layout.camera_indices.size(); ++i) {
    const std::string in_folder = fmt::format("cam{}", layout.camera_indices[i]);
    const std::string sensor = fmt::format("cam{}", i);
    YAML::Node section = cameraSection(layout, kalibr, in_folder);
    std::filesystem::path mask = file;
    mask.replace_extension(sensor + "_mask");
    copyMask(layout.sensor(in_folder), mask, &section);
    root[sensor] = section;
  }
  root["imu0"] = imuSection(layout, kalibr);
  const auto addSmall = [&](const char* sensor, const auto& read) {
    if (topics.contains(sensor)) root[sensor] = knownPart(layout.sensor(sensor) / "sensor.yaml", read);
  };
  addSmall("mag0", [](CalibrationMap* map) { readEurocMagnetometer(map); });
  addSmall("pressure0", [](CalibrationMap* map) { readEurocPressure(map); });
  addSmall("sonar0", [](CalibrationMap* map) { readEurocSonar(map); });
  for (const auto& [sensor, topic] : topics) {
    if (root[sensor].IsDefined()) root[sensor]["topic"] = topic;
  }
  writeYaml(root, file);
}

void writeFolderCalibration(const RigFile& rig_file, const std::filesystem::path& folder) {
  YAML::Node camchain;
  for (const auto& [sensor, section] : rig_file.sections) {
    const std::filesystem::path sensor_folder = folder / "mav0" / sensor;
    YAML::Node here;    // for sensor.yaml
    YAML::Node kalibr;  // for Kalibr's files
    for (const auto& entry : section.node) {
      const std::string key = entry.first.Scalar();
      if (isAmong(key, kOfRigFile)) continue;
      (section.is_kalibr && !isAmong(key, kBesideKalibr) ? kalibr : here)[key] = entry.second;
    }
    copyMask(section.file.parent_path(), sensor_folder / "mask", &here);
    if (here.IsDefined() && here.size() > 0) writeYaml(here, sensor_folder / "sensor.yaml");
    if (!section.is_kalibr) continue;
    if (sensor == "imu0") {
      writeYaml(kalibr, folder / "imu.yaml");
    } else {
      camchain[sensor] = kalibr;
    }
  }
  if (camchain.size() > 0) writeYaml(camchain, folder / "camchain-imucam.yaml");
}

}  // namespace lodeline
