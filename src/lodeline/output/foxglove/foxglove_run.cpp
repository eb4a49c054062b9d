#include "lodeline/output/foxglove/foxglove_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "lodeline/output/files/landmark_file.h"
#include "lodeline/util/csv_fields.h"

namespace lodeline::foxglove {
namespace {

namespace fs = std::filesystem;

/// Whether the file has a line that is no comment. A run whose map was not recognized writes none.
bool hasPoses(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  while (std::getline(stream, line)) {
    const std::string_view text = csv::trimmed(line);
    if (!text.empty() && text.front() != '#') return true;
  }
  return false;
}

void refuseBefore1970(const fs::path& file, Time first) {
  if (first >= Time()) return;
  throw InputError(fmt::format("{}: an MCAP file has no times before 1970, as {} ns is", file.string(),
                               first.nanoseconds()));
}

std::vector<StampedPose> readPoses(const fs::path& file, Diagnostics* diagnostics) {
  TrajectoryReadOptions options;
  options.format = TrajectoryFormat::Tum;
  std::vector<StampedPose> poses = readTrajectory(file, options, *diagnostics).poses;
  if (poses.empty()) throw InputError(file.string() + ": no poses");
  refuseBefore1970(file, poses.front().time);
  return poses;
}

std::vector<StampedPose> readFurtherPoses(const fs::path& file, Diagnostics* diagnostics) {
  if (!fs::exists(file)) return {};
  if (hasPoses(file)) return readPoses(file, diagnostics);
  diagnostics->report(Severity::Notice, "path_empty", file.string() + ": no poses; left out");
  return {};
}

RunTable readStates(const fs::path& file, Diagnostics* diagnostics) {
  RunTable table = readRunTable(file, diagnostics);
  for (const int64_t stamp_ns : table.stamp_ns) refuseBefore1970(file, Time::fromNanoseconds(stamp_ns));
  return table;
}

void readSummary(const fs::path& file, Run* run) {
  try {
    const nlohmann::json json = nlohmann::json::parse(std::ifstream(file));
    run->program = json.value("program", "");
    for (const nlohmann::json& finding : json.value("findings", nlohmann::json::array())) {
      run->findings.push_back({finding.at("severity").get<std::string>(),
                               finding.at("kind").get<std::string>(),
                               finding.at("message").get<std::string>()});
    }
  } catch (const nlohmann::json::exception& error) {
    throw InputError(
        fmt::format("{}: {}; run.json of `lodeline run` is wanted", file.string(), error.what()));
  }
}

/// Pictures STAMP.jpg between the first and the last pose. Other files of the folder are passed over.
std::vector<StoredPicture> findPictures(const fs::path& folder, Time first, Time last) {
  std::vector<StoredPicture> pictures;
  if (!fs::is_directory(folder)) return pictures;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    int64_t stamp_ns = 0;
    if (entry.path().extension() != ".jpg" || !csv::parse(entry.path().stem().string(), &stamp_ns)) continue;
    const Time time = Time::fromNanoseconds(stamp_ns);
    if (first <= time && time <= last) pictures.push_back({time, entry.path()});
  }
  std::sort(pictures.begin(), pictures.end(),
            [](const StoredPicture& a, const StoredPicture& b) { return a.time < b.time; });
  return pictures;
}

}  // namespace

Run readRun(const fs::path& folder, bool with_pictures, Diagnostics* diagnostics) {
  const fs::path trajectory = folder / "trajectory.tum";
  if (!fs::exists(trajectory)) {
    throw InputError(folder.string() +
                     ": no trajectory.tum there; give the folder that `lodeline run -o` wrote");
  }
  const auto there = [&](const char* name, const char* consequence) {
    if (fs::exists(folder / name)) return true;
    diagnostics->report(Severity::Warning, std::string("no_") + name,
                        fmt::format("{}: no {} there: {}", folder.string(), name, consequence));
    return false;
  };
  Run run;
  run.odom_from_body = readPoses(trajectory, diagnostics);
  run.map_from_body = readFurtherPoses(folder / "trajectory_map.tum", diagnostics);
  run.refined_from_body = readFurtherPoses(folder / "trajectory_refined.tum", diagnostics);
  if (there("run.json", "the MCAP file has none of its findings")) readSummary(folder / "run.json", &run);
  if (there("states.csv", "the MCAP file has no /states"))
    run.states = readStates(folder / "states.csv", diagnostics);
  if (there("landmarks.ply", "the MCAP file has no /landmarks"))
    run.landmarks = readLandmarkFile(folder / "landmarks.ply", diagnostics);
  if (with_pictures) {
    run.pictures =
        findPictures(folder / "pictures", run.odom_from_body.front().time, run.odom_from_body.back().time);
    if (run.pictures.empty()) {
      diagnostics->report(
          Severity::Warning, "no_pictures",
          (folder / "pictures").string() + ": no pictures of the run there: the MCAP file has no /pictures");
    }
  }
  return run;
}

}  // namespace lodeline::foxglove
