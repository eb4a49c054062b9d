#include "lodeline/io/calibration/rig_sections.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>

#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/calibration_kind.h"
#include "lodeline/io/calibration/calibration_translation.h"
#include "lodeline/io/calibration/kalibr_calibration.h"
#include "lodeline/sensors/sensor_kind.h"
#include "lodeline/util/edit_distance.h"

namespace lodeline {
namespace {

/// Keys that Kalibr does not write but that may be given beside its own.
constexpr std::array kBesideKalibr = {"rate_hz", "mask", "topic", "port"};

void refuseUnknownSensor(const std::filesystem::path& file, const std::string& key, int line) {
  std::string nearest = "cam0";
  for (const char* sensor : kSingleSensors) {
    if (editDistance(key, sensor) < editDistance(key, nearest)) nearest = sensor;
  }
  throw InputError(fmt::format("{}:{}: unknown sensor '{}'; did you mean '{}'? Known are cam0, cam1, …, {}",
                               file.string(), line, key, nearest, fmt::join(kSingleSensors, ", ")));
}

class SectionCollector {
 public:
  SectionCollector(RigSections* sections, Diagnostics* diagnostics)
      : sections_(sections), diagnostics_(diagnostics) {}

  void take(const std::filesystem::path& file) {
    const YAML::Node root = loadYamlFile(file);
    const CalibrationKind kind = recognizeCalibration(root);
    switch (kind) {
      case CalibrationKind::Rig:
        return takeRig(file, root);
      case CalibrationKind::ImuKeys:
        return add("imu0", {root, file, isKalibrImu(root) ? SectionKeys::Kalibr : SectionKeys::Euroc, ""});
      case CalibrationKind::CameraKeys:
        return add(cameraName(file, root), {root, file, SectionKeys::Euroc, ""});
      case CalibrationKind::OpenVinsEstimator:
        return takeOpenVins(file, root);
      case CalibrationKind::Other:
        throw InputError(fmt::format("{}: {}", file.string(), describeOther(root)));
      default:
        return takeTranslated(file, root, kind);
    }
  }

 private:
  void add(const std::string& sensor, const RigSection& section) {
    const auto [place, is_new] = sections_->emplace(sensor, section);
    if (is_new) return;
    RigSection& known = place->second;
    YAML::Node merged = YAML::Clone(known.node);
    for (const auto& entry : section.node) {
      const std::string key = entry.first.Scalar();
      const bool mixes = (known.keys == SectionKeys::Kalibr || section.keys == SectionKeys::Kalibr) &&
                         std::find(kBesideKalibr.begin(), kBesideKalibr.end(), key) == kBesideKalibr.end();
      if (mixes || merged[key].IsDefined()) {
        throw InputError(
            fmt::format("{}: describes {}, which {} describes too (key '{}'); leave one of them out",
                        section.file.string(), sensor, known.file.string(), key));
      }
      merged[key] = entry.second;
    }
    known.node.reset(merged);  // an assignment would change the file's own node
  }

  void takeRig(const std::filesystem::path& file, const YAML::Node& root) {
    bool is_kalibrs = false;
    for (const auto& entry : root) {
      const std::string sensor = entry.first.Scalar();
      is_kalibrs = is_kalibrs || (isCameraName(sensor) && isKalibrCamera(entry.second)) ||
                   (sensor == "imu0" && isKalibrImu(entry.second));
    }
    for (const auto& entry : root) {
      const std::string sensor = entry.first.Scalar();
      const int line = entry.first.Mark().line + 1;
      if (!isSensorName(sensor)) {
        if (!is_kalibrs) refuseUnknownSensor(file, sensor, line);
        diagnostics_->report(
            Severity::Notice, "calibration_key",
            fmt::format("{}: key '{}' (line {}) is not used and passed over", file.string(), sensor, line));
        continue;
      }
      const bool kalibr =
          isCameraName(sensor) ? isKalibrCamera(entry.second) : sensor == "imu0" && isKalibrImu(entry.second);
      add(sensor, {entry.second, file, kalibr ? SectionKeys::Kalibr : SectionKeys::Rig, sensor});
    }
  }

  void takeOpenVins(const std::filesystem::path& file, const YAML::Node& root) {
    CalibrationMap map(root, file, "");
    for (const char* key : {"relative_config_imu", "relative_config_imucam"}) {
      if (map.has(key)) take(file.parent_path() / map.text(key));
    }
  }

  void takeTranslated(const std::filesystem::path& file, const YAML::Node& root, CalibrationKind kind) {
    CalibrationMap map(root, file, "");
    TranslatedSections translated;
    if (kind == CalibrationKind::Vins) translated = translateVins(&map, diagnostics_);
    if (kind == CalibrationKind::OrbSlam) translated = translateOrbSlam(&map);
    if (kind == CalibrationKind::Okvis) translated = translateOkvis(&map);
    if (kind == CalibrationKind::Basalt) translated = translateBasalt(&map);
    if (kind == CalibrationKind::VinsCamera) translated[cameraName(file, root)] = translateVinsCamera(&map);
    if (kind == CalibrationKind::CameraInfo) translated[cameraName(file, root)] = translateCameraInfo(&map);
    std::string sensors;
    for (const auto& [sensor, node] : translated) {
      add(sensor, {node, file, SectionKeys::Rig, sensor});
      sensors += (sensors.empty() ? "" : ", ") + sensor;
    }
    diagnostics_->report(Severity::Notice, "calibration_translated",
                         fmt::format("{}: read as {}: {}", file.string(), describe(kind), sensors));
  }

  /// The name (number) of a camera with a separate file.
  std::string cameraName(const std::filesystem::path& file, const YAML::Node& root) {
    const int place = single_cameras_++;
    std::vector<std::string> hints;
    for (const char* key : {"camera_name", "camera_id"}) {
      if (root[key].IsDefined() && root[key].IsScalar()) hints.push_back(root[key].Scalar());
    }
    hints.push_back(file.stem().string());
    hints.push_back(std::filesystem::absolute(file).parent_path().filename().string());
    for (std::string hint : hints) {
      std::transform(hint.begin(), hint.end(), hint.begin(),
                     [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
      const size_t cam = hint.find("cam");
      if (cam != std::string::npos && cam + 3 < hint.size() && std::isdigit(hint[cam + 3]) != 0) {
        return hint.substr(cam, hint.find_first_not_of("0123456789", cam + 3) - cam);
      }
    }
    std::string name = fmt::format("cam{}", place);
    for (const std::string& hint : hints) {
      if (hint.find("left") != std::string::npos) name = "cam0";
      if (hint.find("right") != std::string::npos) name = "cam1";
    }
    diagnostics_->report(
        Severity::Notice, "calibration_order",
        fmt::format("{}: does not say which camera it is; taken as {}", file.string(), name));
    return name;
  }

  RigSections* sections_;
  Diagnostics* diagnostics_;
  int single_cameras_ = 0;
};

}  // namespace

RigSections collectRigSections(const std::vector<std::filesystem::path>& files, Diagnostics* diagnostics) {
  RigSections sections;
  SectionCollector collector(&sections, diagnostics);
  for (const std::filesystem::path& file : files) {
    try {
      collector.take(file);
    } catch (const YAML::Exception& error) {
      throw InputError(
          fmt::format("{}: holds something else than a calibration does ({})", file.string(), error.what()));
    }
  }
  return sections;
}

}  // namespace lodeline
