#include "lodeline/io/rosbag/convert/rig_conversion.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "lodeline/diagnostics.h"
#include "lodeline/io/euroc/folder_calibration.h"
#include "lodeline/io/synchronizer/recording_file.h"
#include "lodeline/sensors/sensor_kind.h"

namespace lodeline {
namespace {

/// Keys that Kalibr does not write; in a folder, they are in sensor.yaml.
constexpr std::array kBesideKalibr = {"rate_hz", "mask"};
/// Keys of a rig file that sensor.yaml does not have.
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

/// Copies the mask named in `node` and sets the key to the copy.
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

/// Adds a section, its mask copied beside the rig file.
void addSection(const RigSection& section, const std::string& sensor,
                const std::map<std::string, std::string>& topics, const std::filesystem::path& file,
                YAML::Node* root) {
  YAML::Node node = YAML::Clone(section.node);
  node.remove("rostopic");
  const auto topic = topics.find(sensor);
  if (topic != topics.end()) node["topic"] = topic->second;
  std::filesystem::path mask = file;
  mask.replace_extension(sensor + "_mask");
  copyMask(section.file.parent_path(), mask, &node);
  (*root)[sensor] = node;
}

/// Marks an IMU section of Kalibr without a rate as Kalibr's.
void markKalibr(const RigFile& rig, YAML::Node* root) {
  const auto imu = rig.sections.find("imu0");
  if (imu == rig.sections.end() || !(*root)["imu0"].IsDefined()) return;
  if (imu->second.keys == SectionKeys::Kalibr && !(*root)["imu0"]["update_rate"].IsDefined()) {
    (*root)["imu0"]["update_rate"] = 0;  // 0 means unknown
  }
}

}  // namespace

RigFile numberedRig(RigFile rig, const std::vector<int>& cameras) {
  if (cameras.empty()) return rig;
  const auto renumber = [&](auto entries) {
    auto numbered = entries;
    std::erase_if(numbered, [](const auto& entry) { return entry.first.starts_with("cam"); });
    for (size_t i = 0; i < cameras.size(); ++i) {
      const auto entry = entries.find(fmt::format("cam{}", cameras[i]));
      if (entry != entries.end()) numbered[fmt::format("cam{}", i)] = entry->second;
    }
    return numbered;
  };
  rig.sections = renumber(rig.sections);
  rig.topics = renumber(rig.topics);
  return rig;
}

void writeRigFile(const EurocLayout& layout, const std::map<std::string, std::string>& topics,
                  const std::filesystem::path& file) {
  Diagnostics reported_when_read_in_earnest;
  const RigFile rig =
      numberedRig(readFolderCalibration(layout, &reported_when_read_in_earnest), layout.camera_indices);
  YAML::Node root;
  for (const auto& [sensor, section] : rig.sections) {
    if (sensor.starts_with("cam") || topics.contains(sensor))
      addSection(section, sensor, topics, file, &root);
  }
  markKalibr(rig, &root);
  writeYaml(root, file);
}

void writeRigFile(const RigFile& rig, const std::map<std::string, std::string>& topics,
                  const std::filesystem::path& file) {
  std::map<std::string, std::string> settled = rig.topics;
  for (const auto& [sensor, topic] : topics) settled[sensor] = topic;
  YAML::Node root;
  for (const auto& [sensor, section] : rig.sections) addSection(section, sensor, settled, file, &root);
  markKalibr(rig, &root);
  writeYaml(root, file);
}

void writeFolderCalibration(const RigFile& rig_file, const std::filesystem::path& folder) {
  YAML::Node camchain;
  for (const auto& [sensor, section] : rig_file.sections) {
    const std::filesystem::path sensor_folder = folder / "mav0" / sensor;
    const bool is_kalibr = section.keys == SectionKeys::Kalibr;
    YAML::Node here;    // for sensor.yaml
    YAML::Node kalibr;  // for Kalibr's files
    for (const auto& entry : section.node) {
      const std::string key = entry.first.Scalar();
      if (isAmong(key, kOfRigFile)) continue;
      (is_kalibr && !isAmong(key, kBesideKalibr) ? kalibr : here)[key] = entry.second;
    }
    copyMask(section.file.parent_path(), sensor_folder / "mask", &here);
    if (here.IsDefined() && here.size() > 0) writeYaml(here, sensor_folder / "sensor.yaml");
    if (!is_kalibr) continue;
    if (sensor == "imu0") {
      writeYaml(kalibr, folder / "imu.yaml");
    } else {
      camchain[sensor] = kalibr;
    }
  }
  if (camchain.size() > 0) writeYaml(camchain, folder / "camchain-imucam.yaml");
}

}  // namespace lodeline
