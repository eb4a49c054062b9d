#include "lodeline/survey.h"

#include <fmt/format.h>

#include <array>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/yaml_file.h"
#include "lodeline/output/files/landmark_file.h"
#include "lodeline/trajectory.h"
#include "lodeline/util/csv_fields.h"
#include "lodeline/util/files/file_kind.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

constexpr const char* kCausalTrajectory = "trajectory.tum";

Trajectory readPoses(const fs::path& folder, std::string* file, Diagnostics* diagnostics) {
  for (const char* name : {"trajectory_refined.tum", kCausalTrajectory}) {
    if (!fs::exists(folder / name)) continue;
    *file = name;
    TrajectoryReadOptions options;
    options.format = TrajectoryFormat::Tum;
    return readTrajectory(folder / name, options, *diagnostics);
  }
  const RecognizedFile recognized = recognizeFile(folder);
  const std::string needed = "no trajectory.tum there; give the folder that `lodeline run -o` wrote";
  if (!recognized.isFolder()) refuseFile(recognized, needed);
  throw InputError(fmt::format("{}: {}", folder.string(), needed));
}

/// Columns of states.csv by the names in its header.
class StateColumns {
 public:
  StateColumns(std::string_view header, const fs::path& file) : file_(file) { csv::split(header, &names_); }

  size_t find(const std::string& name) const {
    for (size_t i = 0; i < names_.size(); ++i) {
      if (names_[i] == name) return i;
    }
    throw InputError(
        fmt::format("{}: no column '{}'; states.csv of `lodeline run` is wanted", file_.string(), name));
  }
  size_t count() const { return names_.size(); }

 private:
  fs::path file_;
  std::vector<std::string_view> names_;
};

/// The six entries of the position's covariance, row by row of its upper triangle.
bool readCovariance(const std::vector<std::string_view>& fields, const std::array<size_t, 6>& columns,
                    Mat3* covariance) {
  std::array<double, 6> c;
  for (size_t i = 0; i < columns.size(); ++i) {
    if (!csv::parse(fields[columns[i]], &c[i])) return false;
  }
  *covariance << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  return covariance->allFinite();
}

std::vector<PositionUncertainty> readUncertainties(const fs::path& file) {
  std::ifstream stream(file);
  std::string header, line;
  std::getline(stream, header);
  const StateColumns columns(header, file);
  const std::array<size_t, 6> covariance_columns = {columns.find("cov_pose_00"), columns.find("cov_pose_01"),
                                                    columns.find("cov_pose_02"), columns.find("cov_pose_11"),
                                                    columns.find("cov_pose_12"), columns.find("cov_pose_22")};
  std::vector<PositionUncertainty> uncertainties;
  std::vector<std::string_view> fields;
  while (std::getline(stream, line)) {
    csv::split(line, &fields);
    int64_t stamp_ns = 0;
    // The last line of a killed run may be incomplete, and frames without a pose have no covariance.
    if (fields.size() != columns.count() || !csv::parse(fields[0], &stamp_ns)) continue;
    PositionUncertainty uncertainty;
    uncertainty.time = Time::fromNanoseconds(stamp_ns);
    if (!readCovariance(fields, covariance_columns, &uncertainty.covariance)) continue;
    uncertainties.push_back(uncertainty);
  }
  return uncertainties;
}

HeadingReference headingReference(const std::string& name, const fs::path& file) {
  for (HeadingReference reference :
       {HeadingReference::True, HeadingReference::Magnetic, HeadingReference::Start}) {
    if (name == toString(reference)) return reference;
  }
  throw InputError(
      fmt::format("{}: heading.reference is '{}', which is none of 'true north', 'magnetic "
                  "north', 'start heading'",
                  file.string(), name));
}

/// A summary without a heading comes from a run without north.
void readHeading(const nlohmann::json& json, const fs::path& file, RunFolder* run) {
  if (!json.contains("heading")) return;
  const nlohmann::json& heading = json["heading"];
  run->heading_reference = headingReference(heading.at("reference").get<std::string>(), file);
  if (heading.contains("sigma_rad") && heading["sigma_rad"].is_number()) {
    run->heading_sigma_rad = heading["sigma_rad"].get<double>();
  }
}

/// The gauge's values are in `pressure.gauge`, in older runs in `pressure` itself. Its depths are those of
/// the density that it assumes.
void readStartDepth(const nlohmann::json& json, RunFolder* run) {
  const nlohmann::json pressure = json.value("pressure", nlohmann::json::object());
  const nlohmann::json gauge = pressure.value("gauge", pressure);
  const auto depth = gauge.find("depth_at_origin_m");
  const double density_ratio = gauge.value("density_ratio", 1.0);
  if (depth != gauge.end() && depth->is_number() && density_ratio > 0.0)
    run->depth_at_origin_m = depth->get<double>() / density_ratio;
}

void readCameraCorrections(const nlohmann::json& json, RunFolder* run) {
  // The batch solution has its own where ports are states.
  const nlohmann::json refined = json.value("refinement", nlohmann::json::object());
  const nlohmann::json& from = refined.contains("camera_corrections") ? refined : json;
  if (!from.contains("camera_corrections")) return;
  for (const nlohmann::json& camera : from["camera_corrections"].at("cameras")) {
    Eigen::Matrix<double, 6, 1> correction;
    for (size_t i = 0; i < 3; ++i) {
      correction[static_cast<Eigen::Index>(i)] = camera.at("rotation_rad").at(i).get<double>();
      correction[static_cast<Eigen::Index>(i) + 3] = camera.at("position_m").at(i).get<double>();
    }
    run->camera_corrections.push_back(correction);
    if (camera.contains("port_change")) {
      PortCorrection& port = run->port_corrections.emplace_back();
      for (size_t i = 0; i < 3; ++i)
        port.change[static_cast<Eigen::Index>(i)] = camera["port_change"].at(i).get<double>();
    }
    if (!camera.contains("focal_length")) continue;
    IntrinsicsCorrection intrinsics = IntrinsicsCorrection::Zero();
    for (size_t i = 0; i < 2; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      intrinsics[row] = camera["focal_length"].at(i).get<double>();
      intrinsics[row + 2] = camera.at("principal_point_px").at(i).get<double>();
      intrinsics[row + 4] = camera.at("radial").at(i).get<double>();
      intrinsics[row + 6] = camera.at("tangential").at(i).get<double>();
      intrinsics[row + 8] = camera.at("port_tilt").at(i).get<double>();
    }
    run->intrinsics_corrections.push_back(intrinsics);
  }
}

void readSummary(const fs::path& file, RunFolder* run) {
  try {
    const nlohmann::json json = nlohmann::json::parse(std::ifstream(file));
    run->program = json.value("program", "");
    run->recording = json.value("data", "");
    readHeading(json, file, run);
    readStartDepth(json, run);
    readCameraCorrections(json, run);
  } catch (const nlohmann::json::exception& error) {
    throw InputError(
        fmt::format("{}: {}; run.json of `lodeline run` is wanted", file.string(), error.what()));
  }
}

/// Position and date, if given to the run.
void readSite(const fs::path& file, RunFolder* run) {
  const YAML::Node heading = loadYamlFile(file)["heading"];
  if (!heading) return;
  try {
    if (heading["date"]) run->date = heading["date"].as<std::string>();
    const std::vector<double> site =
        heading["site"] ? heading["site"].as<std::vector<double>>() : std::vector<double>{};
    if (site.size() == 3) run->site = GeodeticPosition{site[0], site[1], site[2]};
  } catch (const YAML::Exception& error) {
    throw InputError(fmt::format("{}: heading.site and heading.date: {}", file.string(), error.what()));
  }
}

}  // namespace

RunFolder readRunFolder(const fs::path& folder, Diagnostics* diagnostics) {
  RunFolder run;
  run.folder = folder;
  run.trajectory = readPoses(folder, &run.trajectory_file, diagnostics);
  const auto there = [&](const char* name, const char* consequence) {
    if (fs::exists(folder / name)) return true;
    diagnostics->report(Severity::Warning, std::string("no_") + name,
                        fmt::format("{}: no {} there: {}", folder.string(), name, consequence));
    return false;
  };
  if (there("run.json", "its heading is taken to be arbitrary")) readSummary(folder / "run.json", &run);
  // Files of the refined trajectory, if that is used.
  const bool refined = run.trajectory_file != kCausalTrajectory;
  const auto choose = [&](const char* name, const char* causal) {
    return refined && fs::exists(folder / name) ? name : causal;
  };
  const char* states = choose("states_refined.csv", "states.csv");
  const char* landmarks = choose("landmarks_refined.ply", "landmarks.ply");
  if (there(states, "how well positions are known is assumed"))
    run.uncertainties = readUncertainties(folder / states);
  if (there(landmarks, "the passage has no walls"))
    run.landmarks = readLandmarkFile(folder / landmarks, diagnostics);
  if (fs::exists(folder / "config.yaml")) readSite(folder / "config.yaml", &run);
  return run;
}

}  // namespace lodeline
