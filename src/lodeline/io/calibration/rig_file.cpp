#include "lodeline/io/calibration/rig_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/calibration_kind.h"
#include "lodeline/io/calibration/calibration_translation.h"
#include "lodeline/io/calibration/euroc_calibration.h"
#include "lodeline/io/calibration/kalibr_calibration.h"

namespace lodeline {
namespace {

constexpr double kGravity_m_per_s2 = 9.80665;
/// Rounding of depths computed from pressures. It is far below the resolution of any sensor, and a decimal
/// depth stays unchanged when it is stored as a pressure.
constexpr double kDepthSteps_per_m = 1e9;

/// Reads the sections in order and stores the topics.
class RigReader {
 public:
  RigReader(RigFile* result, const RigRequirements& requirements, Diagnostics* diagnostics)
      : result_(result), requirements_(requirements), diagnostics_(diagnostics) {}

  void readAll() {
    Rig& rig = result_->rig;
    result_->has_imu = visit("imu0", [&](CalibrationMap* map, SectionKeys keys) { readImu(map, keys); });
    for (const int number : cameraNumbers()) {
      visit(fmt::format("cam{}", number),
            [&](CalibrationMap* map, SectionKeys keys) { readCamera(number, map, keys); });
    }
    visit("mag0", [&](CalibrationMap* map, SectionKeys) {
      rig.magnetometer = readEurocMagnetometer(map);
      moveToBody(&rig.magnetometer->body_from_magnetometer);
    });
    visit("pressure0", [&](CalibrationMap* map, SectionKeys) {
      rig.pressure = readEurocPressure(map);
      moveToBody(&rig.pressure->body_from_pressure);
      readWater(map);
    });
    visit("sonar0", [&](CalibrationMap* map, SectionKeys) {
      rig.sonar = readEurocSonar(map);
      moveToBody(&rig.sonar->body_from_sonar);
    });
    visit("altimeter0", [&](CalibrationMap* map, SectionKeys) {
      rig.altimeter = readEurocSonar(map);
      moveToBody(&rig.altimeter->body_from_sonar);
    });
    visit("dvl0", [&](CalibrationMap* map, SectionKeys) {
      rig.dvl = readDvl(map);
      judgeDelay("timeshift", rig.dvl->time_offset_to_imu_s, *map);
      moveToBody(&rig.dvl->body_from_dvl);
    });
    visit("current0", [&](CalibrationMap* map, SectionKeys) {
      rig.currents = readCurrents(map);
      judgeDelay("timeshift", rig.currents->time_offset_to_imu_s, *map);
    });
  }

 private:
  /// Camera numbers in numeric order; by name, cam10 would precede cam2.
  std::vector<int> cameraNumbers() const {
    std::vector<int> numbers;
    for (const auto& [sensor, section] : result_->sections) {
      if (isCameraName(sensor)) numbers.push_back(std::stoi(sensor.substr(3)));
    }
    std::sort(numbers.begin(), numbers.end());
    for (size_t i = 0; requirements_.needs_all_cameras && i < numbers.size(); ++i) {
      if (numbers[i] == static_cast<int>(i)) continue;
      throw InputError(
          fmt::format("{}: describes cam{} but not cam{}; cameras are counted from cam0 without gaps",
                      result_->sections.at(fmt::format("cam{}", numbers[i])).file.string(), numbers[i], i));
    }
    return numbers;
  }

  template <typename Read>
  bool visit(const std::string& sensor, const Read& read) {
    const auto place = result_->sections.find(sensor);
    if (place == result_->sections.end()) return false;
    RigSection& section = place->second;
    const bool is_mounted = !isCameraName(sensor) || section.keys == SectionKeys::Kalibr ||
                            hasAnyKey(section.node, {"T_BS"}) || requirements_.needs_extrinsics;
    if (!is_mounted && section.node.IsMap()) {
      result_->without_extrinsics.insert(sensor);
      section.node.reset(YAML::Clone(section.node));
      section.node["T_BS"] = transformNode(Rigid3());
    }
    CalibrationMap map(section.node, section.file, section.prefix);
    for (const char* key : {"topic", "rostopic"}) {
      if (map.has(key)) result_->topics[sensor] = map.text(key);
    }
    read(&map, section.keys);
    if (section.keys == SectionKeys::Rig) {
      map.refuseUnknownKeys();
    } else {
      map.reportUnknownKeys(diagnostics_);
    }
    section.node.reset(map.knownPart());
    return true;
  }

  /// Reports a delay to the IMU that no trigger, exposure or cable has. Differences between two clocks are
  /// mostly larger.
  void judgeDelay(const char* key, double delay_s, const CalibrationMap& map) const {
    constexpr double kLongest_s = 0.5, kClocks_s = 1000.0;
    if (std::abs(delay_s) < kLongest_s || std::abs(delay_s) >= kClocks_s) return;
    diagnostics_->report(
        Severity::Serious, "time_offset_unit",
        fmt::format(
            "{} is {:g} s, which no sensor is late; is it in milliseconds? Seconds are due: {:g}. Only "
            "where the clocks of the two sensors differ that much it may stay",
            map.atLine(key), delay_s, 1e-3 * delay_s));
  }

  void readImu(CalibrationMap* map, SectionKeys keys) {
    ImuCalibration& imu = result_->rig.imu;
    if (keys == SectionKeys::Kalibr) {
      const KalibrImu kalibr = readKalibrImu(map);
      imu = kalibr.calibration;
      result_->imu_correction = kalibr.correction;
      body_from_kalibr_body_ = kalibr.imu_from_kalibr_body;
      if (map->has("rate_hz") && !(imu.rate_hz > 0.0)) imu.rate_hz = map->number("rate_hz");
      // If the IMU's file states the pose of its body, the extrinsics of the other sensors refer to that
      // body.
      if (map->has("T_BS")) body_from_euroc_body_ = map->transform("T_BS").inverse();
    } else {
      const EurocImu euroc = readEurocImu(map);
      imu = euroc.calibration;
      result_->imu_correction = euroc.correction;
      body_from_euroc_body_ = euroc.euroc_body_from_imu.inverse();
    }
    if (!result_->imu_correction) return;
    diagnostics_->report(
        Severity::Notice, "imu_correction",
        fmt::format(
            "{}: readings of the IMU are freed from scale, misalignment and bias (up to {:.2g} % of a "
            "reading), and their stamps moved by {:g} ms",
            map->file().string(), 100.0 * result_->imu_correction->largestChange(),
            1e3 * result_->imu_correction->time_offset_s));
  }

  void readCamera(int number, CalibrationMap* map, SectionKeys keys) {
    const std::string name = fmt::format("cam{}", number);
    std::vector<CameraCalibration>& cameras = result_->rig.cameras;
    if (keys == SectionKeys::Kalibr) {
      // Kalibr has no keys for rates and masks; they may be given beside its keys.
      const EurocCameraExtras extras = readEurocCameraExtras(map);
      const bool has_before = before_ && before_number_ == number - 1;
      CameraCalibration camera = readKalibrCamera(number, has_before ? &*before_ : nullptr, map);
      before_ = camera;
      before_number_ = number;
      camera.body_from_camera = body_from_kalibr_body_ * camera.body_from_camera;
      camera.rate_hz = extras.rate_hz;
      camera.mask_file = extras.mask_file;
      judgeDelay("timeshift_cam_imu", camera.time_offset_to_imu_s, *map);
      cameras.push_back(std::move(camera));
      return;
    }
    cameras.push_back(readEurocCamera(name, map));
    judgeDelay("timeshift_cam_imu", cameras.back().time_offset_to_imu_s, *map);
    moveToBody(&cameras.back().body_from_camera);
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

  RigFile* result_;
  RigRequirements requirements_;
  Diagnostics* diagnostics_;
  Rigid3 body_from_euroc_body_, body_from_kalibr_body_;
  std::optional<CameraCalibration> before_;  ///< the previous Kalibr camera, in Kalibr's body frame
  int before_number_ = 0;
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
  return readRig(collectRigSections(files, diagnostics), {}, diagnostics);
}

RigFile readRig(const RigSections& sections, const RigRequirements& requirements, Diagnostics* diagnostics) {
  RigFile result;
  result.sections = sections;
  RigReader(&result, requirements, diagnostics).readAll();
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

DescribedRig readRig(const std::vector<std::filesystem::path>& files, Diagnostics* diagnostics) {
  const RigFile file = readRigFiles(files, diagnostics);
  const std::string names = files.empty() ? "no file" : files.front().string();
  if (!file.has_imu) {
    throw InputError(
        fmt::format("{}: no section imu0 in the rig's files (or Kalibr's imu.yaml is missing)", names));
  }
  if (file.rig.cameras.empty()) throw InputError(fmt::format("{}: no camera in the rig's files", names));
  return {file.rig, file.imu_correction};
}

std::filesystem::path rigFileBeside(const std::filesystem::path& recording) {
  std::filesystem::path file = recording.has_filename() ? recording : recording.parent_path();
  if (file.extension() == ".zstd") file.replace_extension();
  // The name of a folder, which may not exist yet, can have dots.
  const std::string extension = file.extension().string();
  const bool is_bag = extension == ".bag" || extension == ".db3" || extension == ".mcap";
  std::error_code ignored;
  if (is_bag || std::filesystem::is_regular_file(recording, ignored)) file.replace_extension();
  file += ".rig.yaml";
  return file;
}

RigFile readRigOf(const std::filesystem::path& recording, const std::string& kind,
                  const std::vector<std::filesystem::path>& rig_files, bool needs_calibration,
                  Diagnostics* diagnostics) {
  if (!rig_files.empty()) return readRigFiles(rig_files, diagnostics);
  const std::filesystem::path beside = rigFileBeside(recording);
  if (std::filesystem::exists(beside)) return readRigFiles({beside}, diagnostics);
  if (!needs_calibration) return {};
  throw InputError(
      fmt::format("{}: {} does not hold the calibration; describe the rig with --rig FILE, or in {} "
                  "(docs/reference/file-formats.md shows how)",
                  recording.string(), kind, beside.string()));
}

}  // namespace lodeline
