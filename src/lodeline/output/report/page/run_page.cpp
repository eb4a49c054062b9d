#include "lodeline/output/report/page/run_page.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "lodeline/diagnostics.h"
#include "lodeline/output/files/landmark_file.h"
#include "lodeline/output/report/data/base64.h"
#include "lodeline/output/report/data/wall_file.h"
#include "lodeline/output/report/page/map_page.h"
#include "lodeline/output/report/page/solutions.h"
#include "lodeline/output/report/page/table_json.h"
#include "lodeline/util/csv_fields.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

/// Reads a file; empty where it does not exist.
std::string readWhole(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::stringstream text;
  if (stream) text << stream.rdbuf();
  return text.str();
}

nlohmann::ordered_json readSummary(const fs::path& file) {
  const std::string text = readWhole(file);
  if (text.empty()) return nlohmann::ordered_json::object();
  try {
    return nlohmann::ordered_json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    throw InputError(fmt::format("{}: no JSON ({})", file.string(), error.what()));
  }
}

nlohmann::ordered_json landmarksJson(const fs::path& file, Diagnostics* diagnostics) {
  if (!fs::exists(file)) return cloudJson({}, 0);
  const std::vector<MapLandmark> all = readLandmarkFile(file, diagnostics);
  ColouredPoints points;
  for (const MapLandmark& landmark : all) points.positions.push_back(landmark.position.cast<float>());
  return cloudJson(points, kMostLandmarks);
}

/// The JPEGs of SamplePictures, by time.
nlohmann::ordered_json picturesJson(const fs::path& folder, int64_t origin_ns) {
  std::vector<std::pair<int64_t, fs::path>> files;
  if (fs::is_directory(folder)) {
    for (const auto& entry : fs::directory_iterator(folder)) {
      int64_t stamp_ns = 0;
      const bool is_picture = entry.path().extension() == ".jpg";
      if (is_picture && csv::parse(entry.path().stem().string(), &stamp_ns))
        files.emplace_back(stamp_ns, entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const auto& [stamp_ns, file] : files) {
    const std::string jpeg = readWhole(file);
    json.push_back({{"t_s", shortNumber(1e-9 * static_cast<double>(stamp_ns - origin_ns))},
                    {"jpeg", base64({reinterpret_cast<const uint8_t*>(jpeg.data()), jpeg.size()})}});
  }
  return json;
}

/// null where the run does not have this file, or was killed before it wrote a row.
nlohmann::ordered_json optionalTable(const fs::path& file, int64_t origin_ns, Diagnostics* diagnostics) {
  std::error_code error;
  if (fs::file_size(file, error) == 0 || error) return nullptr;
  return tableJson(readRunTable(file, diagnostics), origin_ns);
}

/// Expected norm of corrected readings, T, and its source: the field at the run's site, else the run's
/// estimate, else the field at the place of calibration.
std::pair<nlohmann::ordered_json, const char*> fieldStrength(const nlohmann::ordered_json& summary) {
  const auto calibration = summary.value("/rig/magnetometer"_json_pointer, nlohmann::ordered_json::object());
  if (calibration.contains("site_field_strength_T"))
    return {calibration["site_field_strength_T"], "the field at the site"};
  const auto field_W = summary.value("/magnetometer/field_W_T"_json_pointer, std::vector<double>{});
  if (field_W.size() == 3) return {std::hypot(field_W[0], field_W[1], field_W[2]), "the field as estimated"};
  if (calibration.contains("field_strength_T"))
    return {calibration["field_strength_T"], "the field where it was calibrated"};
  return {nullptr, "their mean"};
}

nlohmann::ordered_json magnetometerJson(const fs::path& run, const nlohmann::ordered_json& summary,
                                        int64_t origin_ns, Diagnostics* diagnostics) {
  nlohmann::ordered_json table = optionalTable(run / "magnetometer.csv", origin_ns, diagnostics);
  if (table.is_null()) return nullptr;
  const auto [strength_T, origin] = fieldStrength(summary);
  return {{"table", std::move(table)},
          {"is_calibrated", summary.value("/rig/magnetometer/is_calibrated"_json_pointer, false)},
          {"field_strength_T", strength_T},
          {"field_strength_from", origin}};
}

std::string nameOf(const fs::path& run) {
  const fs::path absolute = fs::absolute(run).lexically_normal();
  return (absolute.has_filename() ? absolute : absolute.parent_path()).filename().string();
}

/// Points that `lodeline walls` made in a folder, turned back from north to the world of the run.
ColouredPoints madeWalls(const fs::path& folder) {
  ColouredPoints points = readWallFile(folder / "cloud.ply");
  std::ifstream summary(folder / "walls.json");
  const auto json = nlohmann::json::parse(summary, nullptr, false);
  const double turn_rad = json.is_object() ? json.value("turn_rad", 0.0) : 0.0;
  const Eigen::Matrix3f world_from_north =
      Eigen::AngleAxisf(static_cast<float>(turn_rad), Eigen::Vector3f::UnitZ()).toRotationMatrix();
  for (Eigen::Vector3f& position : points.positions) position = world_from_north * position;
  return points;
}

/// The file walls.ply of a run, or what `lodeline walls` made; null where the run has neither.
nlohmann::ordered_json wallsJson(const fs::path& run, size_t runs) {
  if (fs::exists(run / "walls.ply"))
    return cloudJson(readWallFile(run / "walls.ply"), kMostWallPoints / runs);
  if (!fs::exists(run / "walls" / "cloud.ply")) return nullptr;
  return cloudJson(madeWalls(run / "walls"), kMostWallPoints / runs);
}

}  // namespace

nlohmann::ordered_json runPageJson(const fs::path& run, const ReportOptions& options,
                                   Diagnostics* diagnostics, size_t runs) {
  const size_t most_rows = runs > 1 ? kMostRowsOfAllRuns / runs : kMostRows;
  const bool is_refined = fs::exists(run / "states_refined.csv");
  const RunTable states = readRunTable(run / (is_refined ? "states_refined.csv" : "states.csv"), diagnostics);
  const int64_t origin_ns = states.rows() > 0 ? states.stamp_ns.front() : 0;
  nlohmann::ordered_json json;
  int parts_done = 0;
  const auto nextPart = [&] { options.progress(parts_done++ / 10.0); };
  nextPart();
  json["name"] = nameOf(run);
  json["origin_ns"] = std::to_string(origin_ns);
  json["is_refined"] = is_refined;
  json["summary"] = readSummary(run / "run.json");
  json["config"] = readWhole(run / "config.yaml");
  json["states"] = tableJson(states, origin_ns, most_rows, isForThePage);
  nextPart();
  json["landmarks"] =
      landmarksJson(run / (is_refined ? "landmarks_refined.ply" : "landmarks.ply"), diagnostics);
  nextPart();
  json["others"] = otherSolutionsJson(run, is_refined, origin_ns, most_rows, diagnostics);
  nextPart();
  json["walls"] = wallsJson(run, runs);
  nextPart();
  json["pictures"] = picturesJson(run / "pictures", origin_ns);
  nextPart();
  json["timings"] = optionalTable(run / "timings.csv", origin_ns, diagnostics);
  nextPart();
  json["magnetometer"] = magnetometerJson(run, json["summary"], origin_ns, diagnostics);
  nextPart();
  json["map"] = runMapJson(run, origin_ns, diagnostics);
  nextPart();
  json["stations"] = nullptr;
  if (options.stations) json["stations"] = options.stations(run, origin_ns);
  nextPart();
  json["evaluation"] = nullptr;
  if (options.reference) json["evaluation"] = runEvaluationJson(run, *options.reference, origin_ns);
  return json;
}

}  // namespace lodeline
