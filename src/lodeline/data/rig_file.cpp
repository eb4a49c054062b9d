#include "lodeline/data/rig_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "lodeline/base/edit_distance.h"
#include "lodeline/base/error.h"
#include "lodeline/data/euroc_calibration.h"
#include "lodeline/data/kalibr_calibration.h"

namespace lodeline {
namespace {

constexpr double kGravity_m_per_s2 = 9.80665;
/// Depths that came from pressures are rounded to this, far below what any sensor resolves, so that a depth
/// in decimals survives being kept as a pressure.
constexpr double kDepthSteps_per_m = 1e9;

constexpr std::array<const char*, 4> kSingleSensors = {"imu0", "mag0", "pressure0", "sonar0"};

bool isCamera(const std::string& key) {
  return key.size() > 3 && key.starts_with("cam") &&
         std::all_of(key.begin() + 3, key.end(), [](char c) { return c >= '0' && c <= '9'; });
}

bool hasAny(const YAML::Node& node, std::initializer_list<const char*> keys) {
  return node.IsMap() &&
         std::any_of(keys.begin(), keys.end(), [&](const char* key) { return node[key].IsDefined(); });
}

bool isKalibrs(const std::string& sensor, const YAML::Node& node) {
  if (isCamera(sensor)) return hasAny(node, {"T_cam_imu", "T_cn_cnm1", "distortion_coeffs"});
  return sensor == "imu0" && hasAny(node, {"update_rate", "T_i_b", "rostopic"});
}

void refuseUnknownSensor(const std::filesystem::path& file, const std::string& key, int line) {
  std::string nearest = "cam0";
  for (const char* sensor : kSingleSensors) {
    if (editDistance(key, sensor) < editDistance(key, nearest)) nearest = sensor;
  }
  throw InputError(
      fmt::format("{}:{}: unknown sensor '{}'; did you mean '{}'? Known are cam0, cam1, …, imu0, mag0, "
                  "pressure0, sonar0",
                  file.string(), line, key, nearest));
}

void collectSections(const std::filesystem::path& file, std::map<std::string, RigSection>* sections) {
  const YAML::Node root = loadYamlFile(file);
  const auto add = [&](const std::string& sensor, const YAML::Node& node, bool is_kalibr) {
    const auto [known, is_new] = sections->emplace(sensor, RigSection{node, file, is_kalibr});
    if (is_new) return;
    throw InputError(fmt::format("{}: describes {}, which {} describes too; leave one of them out",
                                 file.string(), sensor, known->second.file.string()));
  };
  // Kalibr's imu.yaml has the IMU's keys at its top.
  if (hasAny(root, {"gyroscope_noise_density"})) return add("imu0", root, true);
  if (!root.IsMap()) throw InputError(file.string() + ": holds no sensors; see docs/data.md for a rig file");
  for (const auto& entry : root) {
    const std::string sensor = entry.first.Scalar();
    const bool known = isCamera(sensor) || std::find(kSingleSensors.begin(), kSingleSensors.end(), sensor) !=
                                               kSingleSensors.end();
    if (!known) refuseUnknownSensor(file, sensor, entry.first.Mark().line + 1);
    add(sensor, entry.second, isKalibrs(sensor, entry.second));
  }
}

/// Reads the sections one after the other, keeping the topics.
class RigReader {
 public:
  RigReader(RigFile* result, Diagnostics* diagnostics) : result_(result), diagnostics_(diagnostics) {}

  void readAll() {
    Rig& rig = result_->rig;
    result_->has_imu = visit("imu0", [&](CalibrationMap* map, bool is_kalibr) { readImu(map, is_kalibr); });
    for (bool found = true; found;) {
      const std::string name = fmt::format("cam{}", rig.cameras.size());
      found = visit(name, [&](CalibrationMap* map, bool is_kalibr) { readCamera(name, map, is_kalibr); });
    }
    visit("mag0", [&](CalibrationMap* map, bool) {
      rig.magnetometer = readEurocMagnetometer(map);
      moveToBody(&rig.magnetometer->body_from_magnetometer);
    });
    visit("pressure0", [&](CalibrationMap* map, bool) {
      rig.pressure = readEurocPressure(map);
      moveToBody(&rig.pressure->body_from_pressure);
      readWater(map);
    });
    visit("sonar0", [&](CalibrationMap* map, bool) {
      rig.sonar = readEurocSonar(map);
      moveToBody(&rig.sonar->body_from_sonar);
    });
    requireGaplessCameras();
  }

 private:
  template <typename Read>
  bool visit(const std::string& sensor, const Read& read) {
    const auto section = result_->sections.find(sensor);
    if (section == result_->sections.end()) return false;
    const auto& [node, file, is_kalibr] = section->second;
    const bool is_whole_file = is_kalibr && sensor == "imu0" && !hasAny(loadYamlFile(file), {"imu0"});
    CalibrationMap map(node, file, is_whole_file ? "" : sensor);
    for (const char* key : {"topic", "rostopic"}) {
      if (map.has(key)) result_->topics[sensor] = map.text(key);
    }
    read(&map, is_kalibr);
    if (is_kalibr) {
      map.reportUnknownKeys(diagnostics_);
    } else {
      map.refuseUnknownKeys();
    }
    return true;
  }

  void readImu(CalibrationMap* map, bool is_kalibr) {
    if (is_kalibr) {
      result_->rig.imu = readKalibrImu(map);
      return;
    }
    const EurocImu imu = readEurocImu(map);
    result_->rig.imu = imu.calibration;
    body_from_euroc_body_ = imu.euroc_body_from_imu.inverse();
  }

  void readCamera(const std::string& name, CalibrationMap* map, bool is_kalibr) {
    std::vector<CameraCalibration>& cameras = result_->rig.cameras;
    if (!is_kalibr) {
      cameras.push_back(readEurocCamera(name, map));
      moveToBody(&cameras.back().body_from_camera);
      return;
    }
    // Kalibr knows neither rates nor masks; they may stand beside its keys.
    const EurocCameraExtras extras = readEurocCameraExtras(map);
    cameras.push_back(readKalibrCamera(cameras, map));
    cameras.back().rate_hz = extras.rate_hz;
    cameras.back().mask_file = extras.mask_file;
  }

  void readWater(CalibrationMap* map) {
    WaterColumn& water = result_->water;
    water.density_kg_per_m3 = map->numberOr("water_density_kg_per_m3", water.density_kg_per_m3);
    water.surface_pressure_Pa = map->numberOr("surface_pressure_Pa", water.surface_pressure_Pa);
    if (!(water.density_kg_per_m3 > 0.0)) {
      throw InputError(map->atLine("water_density_kg_per_m3") +
                       " must be positive; fresh water has 1000, sea water 1025");
    }
  }

  void moveToBody(Rigid3* body_from_sensor) const {
    *body_from_sensor = body_from_euroc_body_ * *body_from_sensor;
  }

  void requireGaplessCameras() const {
    for (const auto& [sensor, section] : result_->sections) {
      if (!isCamera(sensor) || std::stoul(sensor.substr(3)) < result_->rig.cameras.size()) continue;
      throw InputError(
          fmt::format("{}: describes {} but not cam{}; cameras are counted from cam0 without gaps",
                      section.file.string(), sensor, result_->rig.cameras.size()));
    }
  }

  RigFile* result_;
  Diagnostics* diagnostics_;
  Rigid3 body_from_euroc_body_;
};

}  // namespace

double WaterColumn::depth_m(double pressure_Pa) const {
  const double depth_m = (pressure_Pa - surface_pressure_Pa) / (density_kg_per_m3 * kGravity_m_per_s2);
  return std::round(depth_m * kDepthSteps_per_m) / kDepthSteps_per_m;
}

double WaterColumn::pressure_Pa(double depth_m) const {
  return surface_pressure_Pa + depth_m * density_kg_per_m3 * kGravity_m_per_s2;
}

RigFile readRigFiles(const std::vector<std::filesystem::path>& files, Diagnostics* diagnostics) {
  RigFile result;
  for (const std::filesystem::path& file : files) collectSections(file, &result.sections);
  RigReader(&result, diagnostics).readAll();
  return result;
}

void selectCameras(const std::vector<int>& indices, const std::string& name, Rig* rig) {
  if (indices.empty()) return;
  std::vector<CameraCalibration> selected;
  for (const int index : indices) {
    if (index < 0 || index >= static_cast<int>(rig->cameras.size())) {
      throw InputError(fmt::format("{}: camera {} was asked for, but the rig has {} cameras", name, index,
                                   rig->cameras.size()));
    }
    selected.push_back(rig->cameras[static_cast<size_t>(index)]);
  }
  rig->cameras = std::move(selected);
}

}  // namespace lodeline
