#include "lodeline/io/euroc/folder_calibration.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>

#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/calibration_kind.h"
#include "lodeline/io/calibration/kalibr_calibration.h"
#include "lodeline/sensors/sensor_kind.h"
#include "lodeline/util/files/file_kind.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

bool isChainName(const std::string& stem) {
  return stem.find("camchain-imucam") != std::string::npos ||
         stem.find("kalibr_imucam_chain") != std::string::npos;
}

bool isImuName(const std::string& stem) {
  return stem == "imu" || stem == "imu0" || stem.starts_with("imu-") || stem.ends_with("-imu") ||
         stem.find("kalibr_imu_chain") != std::string::npos;
}

bool couldBeCalibration(const fs::path& file) {
  const std::string extension = file.extension().string();
  return extension == ".yaml" || extension == ".yml" || extension == ".json";
}

std::vector<fs::path> calibrationsIn(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (auto entry = fs::directory_iterator(folder, error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    std::error_code ignored;
    if (couldBeCalibration(entry->path()) && entry->is_regular_file(ignored)) files.push_back(entry->path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

fs::path folderOf(const EurocLayout& layout) {
  return fs::absolute(layout.mav0).lexically_normal().parent_path();
}

std::optional<fs::path> findNamed(const fs::path& folder, bool (*matches)(const std::string& stem)) {
  std::vector<fs::path> found = calibrationsIn(folder);
  std::erase_if(found, [&](const fs::path& file) { return !matches(file.stem().string()); });
  if (found.empty()) return std::nullopt;
  if (found.size() > 1) {
    throw InputError(
        fmt::format("{} and {} both look like Kalibr's result; keep the one that is valid, or name it "
                    "with --rig",
                    found[0].string(), found[1].filename().string()));
  }
  return found[0];
}

/// Files beside the recording, in it, and in the folders beside mav0, such as TUM-VI's `dso`.
std::vector<fs::path> filesAround(const EurocLayout& layout) {
  std::vector<fs::path> folders = {folderOf(layout), layout.mav0};
  std::error_code error;
  for (auto entry = fs::directory_iterator(folderOf(layout), error);
       !error && entry != fs::directory_iterator(); entry.increment(error)) {
    std::error_code ignored;
    if (entry->is_directory(ignored) && entry->path().filename() != layout.mav0.filename()) {
      folders.push_back(entry->path());
    }
  }
  std::sort(folders.begin() + 2, folders.end());
  std::vector<fs::path> files;
  for (const fs::path& folder : folders) {
    const std::vector<fs::path> here = calibrationsIn(folder);
    files.insert(files.end(), here.begin(), here.end());
  }
  return files;
}

/// The sensors that a file describes completely; none where it is not a calibration.
RigFile describedBy(const fs::path& file) {
  try {
    Diagnostics ignored;
    return readRigFiles({file}, &ignored);
  } catch (const InputError&) {
    return {};
  }
}

class FolderCalibration {
 public:
  FolderCalibration(const EurocLayout& layout, Diagnostics* diagnostics)
      : layout_(layout), diagnostics_(diagnostics) {
    for (const int index : layout.camera_indices) sensors_.push_back(fmt::format("cam{}", index));
    for (const char* sensor : kSingleSensors) {
      if (fs::exists(layout.csv(sensor))) sensors_.push_back(sensor);
    }
  }

  RigFile read() {
    sections_ = collectRigSections(givenFiles(), diagnostics_);
    for (const std::string& sensor : sensors_) addOwnFile(sensor);
    searchFor([](const std::string& sensor) { return isCameraName(sensor); });
    searchFor([](const std::string& sensor) { return sensor == "imu0"; });
    for (const std::string& sensor : sensors_) {
      if (!sections_.contains(sensor)) complain(sensor);
    }
    return readRig(sections_, {.needs_all_cameras = false}, diagnostics_);
  }

 private:
  std::vector<fs::path> givenFiles() const {
    if (!layout_.rig_files.empty()) return layout_.rig_files;
    std::vector<fs::path> files;
    for (bool (*matches)(const std::string&) : {isChainName, isImuName}) {
      std::optional<fs::path> file = findNamed(folderOf(layout_), matches);
      if (!file) file = findNamed(layout_.mav0, matches);
      if (file) files.push_back(*file);
    }
    return files;
  }

  /// Adds the sensor's own file, either completely or only the keys that Kalibr does not write.
  void addOwnFile(const std::string& sensor) {
    const fs::path file = layout_.sensor(sensor) / "sensor.yaml";
    const auto known = sections_.find(sensor);
    const bool describes_others = std::any_of(sections_.begin(), sections_.end(), [](const auto& entry) {
      return isCameraName(entry.first) && entry.second.prefix != "";
    });
    if (known == sections_.end()) {
      if (isCameraName(sensor) && describes_others) {
        throw InputError(fmt::format("{}: key '{}' is missing, but the recording has this camera",
                                     sections_.begin()->second.file.string(), sensor));
      }
      if (fs::exists(file))
        sections_.emplace(sensor, RigSection{loadYamlFile(file), file, SectionKeys::Euroc, ""});
      return;
    }
    if (!fs::exists(file)) return;
    if (layout_.rig_files.empty() && (sensor == "cam0" || sensor == "imu0")) {
      diagnostics_->report(
          Severity::Notice, "kalibr_used",
          fmt::format("calibration taken from {} instead of {}", known->second.file.string(), file.string()));
    }
    if (known->second.keys != SectionKeys::Kalibr) return;
    YAML::Node section = YAML::Clone(known->second.node);
    const YAML::Node own = loadYamlFile(file);
    // Kalibr's chain replaces the T_BS of a camera. The T_BS of an IMU gives the pose of the other sensors'
    // body.
    for (const std::string key : {"rate_hz", "mask", sensor == "imu0" ? "T_BS" : "rate_hz"}) {
      if (!own[key].IsDefined() || section[key].IsDefined()) continue;
      if (key == "mask") {
        section[key] = fs::absolute(file.parent_path() / own[key].Scalar()).string();
      } else {
        section[key] = own[key];
      }
    }
    known->second.node.reset(section);
  }

  /// Searches the files around the recording for the only one that describes the sensors without a
  /// calibration.
  template <typename IsWanted>
  void searchFor(const IsWanted& is_wanted) {
    std::vector<std::string> missing;
    for (const std::string& sensor : sensors_) {
      if (is_wanted(sensor) && !sections_.contains(sensor)) missing.push_back(sensor);
    }
    if (missing.empty() || !layout_.rig_files.empty()) return;
    std::vector<fs::path> found;
    RigSections chosen;
    for (const fs::path& file : filesAround(layout_)) {
      const RigFile described = describedBy(file);
      const bool has_all = std::all_of(missing.begin(), missing.end(), [&](const std::string& sensor) {
        return described.sections.contains(sensor);
      });
      if (!has_all) continue;
      found.push_back(file);
      chosen = collectRigSections({file}, diagnostics_);
    }
    if (found.size() > 1 && layout_.needs_calibration) {
      throw InputError(
          fmt::format("{} and {} could both be the calibration of {}; name the one that is valid with "
                      "--rig",
                      found[0].string(), found[1].string(), fmt::join(missing, ", ")));
    }
    if (found.size() != 1) return;
    for (const auto& [sensor, section] : chosen) {
      if (is_wanted(sensor)) sections_.emplace(sensor, section);
    }
    diagnostics_->report(
        Severity::Notice, "calibration_found",
        fmt::format("calibration of {} taken from {}", fmt::join(missing, ", "), found[0].string()));
  }

  void complain(const std::string& sensor) const {
    const std::string file = (layout_.sensor(sensor) / "sensor.yaml").string();
    if (!layout_.needs_calibration) {
      diagnostics_->report(
          Severity::Warning, sensor + "_uncalibrated",
          fmt::format("{}: calibration file missing; {} is taken as it is, in body axes", file, sensor));
      return;
    }
    if (!isCameraName(sensor) && sensor != "imu0") return;  // optional sensors, whose readings decide
    std::string seen;
    for (const fs::path& around : filesAround(layout_)) {
      seen += fmt::format("{} {}", seen.empty() ? "; passed over, as they do not describe it:" : ",",
                          around.lexically_relative(folderOf(layout_)).string());
    }
    throw InputError(
        fmt::format("{}: calibration file missing. Give one with --rig FILE (Kalibr's, OpenVINS's or another "
                    "program's: docs/reference/file-formats.md), or put camchain-imucam.yaml and imu.yaml "
                    "beside mav0, or a sensor.yaml "
                    "there{}",
                    file, seen));
  }

  const EurocLayout& layout_;
  Diagnostics* diagnostics_;
  std::vector<std::string> sensors_;
  RigSections sections_;
};

}  // namespace

RigFile readFolderCalibration(const EurocLayout& layout, Diagnostics* diagnostics) {
  return FolderCalibration(layout, diagnostics).read();
}

}  // namespace lodeline
