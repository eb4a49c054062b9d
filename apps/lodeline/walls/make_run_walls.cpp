#include "apps/lodeline/walls/make_run_walls.h"

#include <fmt/core.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "apps/lodeline/shared/interruption.h"
#include "apps/lodeline/shared/place_argument.h"
#include "lodeline/output/report/findings.h"
#include "lodeline/output/survey/formats/recording_images.h"
#include "lodeline/pipeline/process_usage.h"
#include "lodeline/pipeline/stop_request.h"
#include "lodeline/util/files/folder_lock.h"
#include "lodeline/util/files/output_file.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSummary = "walls.json";

std::string recordingOf(const WallsArguments& arguments, const RunFolder& run) {
  if (!arguments.recording.empty()) return arguments.recording;
  if (!run.recording.empty() && fs::exists(run.recording)) return run.recording;
  throw UsageError(fmt::format("{}: the run's recording{} is not there; name its place with --recording",
                               arguments.run, run.recording.empty() ? "" : " " + run.recording));
}

/// Throws UsageError where the folder has walls of another run.
void expectOwnWalls(const fs::path& folder, const DiveMap& map) {
  std::ifstream stream(folder / kSummary);
  if (!stream) return;
  const nlohmann::json json = nlohmann::json::parse(stream, nullptr, false);
  const std::string other = json.is_object() ? json.value("run", "") : "";
  if (other == map.run_folder.string()) return;
  throw UsageError(fmt::format("{}: has walls of {}; choose another folder with -o, or say --overwrite",
                               folder.string(), other.empty() ? "another run" : other));
}

/// Keeps the poses of a part of the run. Throws UsageError where fewer than two are left.
void keepPart(const RecordingPart& part, RunFolder* run) {
  if (part.isAll() || run->trajectory.poses.empty()) return;
  const Time start = run->trajectory.poses.front().time;
  const double end_s = part.from_s + part.length_s().value_or(HUGE_VAL);
  const auto isOutside = [&](const auto& stamped) {
    const double since_s = (stamped.time - start).seconds();
    return since_s < part.from_s || since_s > end_s;
  };
  std::erase_if(run->trajectory.poses, isOutside);
  std::erase_if(run->uncertainties, isOutside);
  if (run->trajectory.poses.size() < 2)
    throw UsageError(fmt::format("{}: fewer than two poses lie in the part that --from and --to choose",
                                 run->folder.string()));
}

DiveMapOptions mapOptionsOf(const WallsArguments& arguments, Diagnostics* diagnostics) {
  DiveMapOptions options = arguments.map;
  if (!arguments.entrance.empty())
    options.entrance = placeFromText(arguments.entrance, "--entrance", diagnostics);
  return options;
}

std::vector<CameraCalibration> wallCameras(const WallsArguments& arguments, const Rig& rig,
                                           const RunFolder& run) {
  std::vector<CameraCalibration> cameras = camerasOfRun(rig, run);
  if (cameras.empty()) throw InputError("walls: the recording has no camera");
  cameras.resize(std::min<size_t>(cameras.size(), arguments.one_camera ? 1 : 2));
  return cameras;
}

nlohmann::ordered_json summaryOf(const WallsArguments& arguments, const DiveMap& map,
                                 const WallResult& result, const Diagnostics& diagnostics) {
  const ProcessUsage usage = ProcessUsage::now();
  nlohmann::ordered_json json;
  json["run"] = map.run_folder.string();
  json["axes"] = map.north.axes;
  json["turn_rad"] = map.north.turn_rad;
  json["keyframes"] = result.keyframes;
  json["dive_s"] = result.dive_s;
  json["points"] = result.tiles.vertices;
  json["triangles"] = result.tiles.triangles;
  json["voxel_m"] = arguments.walls.fusion.voxel_m;
  json["volume_m3"] = result.volume.volume_m3;
  json["volume_length_m"] = result.volume.length_m;
  json["seconds"] = {{"depths", result.depths_s}, {"surface", result.fusion_s}, {"files", result.files_s}};
  json["processor_s"] = usage.processor_s;
  json["peak_memory_MB"] = usage.peak_memory_MB;
  json["findings"] = findingsJson(diagnostics);
  return json;
}

void print(const WallResult& result, const WallsArguments& arguments) {
  const double work_s = result.depths_s + result.fusion_s + result.files_s;
  fmt::print("{} keyframes of {:.0f} s of dive, {} points, {} triangles with cells of {:g} cm\n",
             result.keyframes, result.dive_s, result.tiles.vertices, result.tiles.triangles,
             100.0 * arguments.walls.fusion.voxel_m);
  if (result.volume.length_m > 0.0) {
    fmt::print("volume {:.0f} m3 along {:.1f} m of passage, mean area {:.1f} m2\n", result.volume.volume_m3,
               result.volume.length_m, result.volume.volume_m3 / result.volume.length_m);
  }
  fmt::print("{:.1f} s of work, {:.2f} x the time of the dive; {:.0f} MB of memory\n", work_s,
             work_s / std::max(result.dive_s, 1e-3), ProcessUsage::now().peak_memory_MB);
  for (const fs::path& file : result.files) fmt::print("written: {}\n", file.string());
}

}  // namespace

void makeRunWalls(const WallsArguments& arguments) {
  cv::setNumThreads(1);  // keyframes and blocks are what runs side by side
  Diagnostics diagnostics;
  RunFolder run = readRunFolder(arguments.run, &diagnostics);
  keepPart(arguments.part, &run);
  const DiveMap map = makeDiveMap(run, mapOptionsOf(arguments, &diagnostics), {}, &diagnostics);
  const fs::path folder =
      arguments.output.empty() ? fs::path(arguments.run) / "walls" : fs::path(arguments.output);
  if (!arguments.overwrite) expectOwnWalls(folder, map);
  const std::unique_ptr<RecordedSource> source =
      openRecording(recordingOf(arguments, run), EurocOptions(), arguments.bag, &diagnostics);
  createOutputFolder(folder);
  const FolderLock lock(folder);
  const StopRequest stop;
  Progress progress("walls", arguments.verbosity.quiet);
  WallResult result = makeWalls(
      map, *source, wallCameras(arguments, source->rig(), run), arguments.walls, folder,
      [&](const char* stage, double share) {
        progress.begin(stage);
        progress.show(share);
        return !stop.made();
      },
      &diagnostics);
  progress.end();
  if (!result.complete)
    throw Interruption(fmt::format("{}: the same command goes on where this one stopped", folder.string()));
  result.files.push_back(folder / kSummary);
  writeOutput(result.files.back(), summaryOf(arguments, map, result, diagnostics).dump(2) + "\n");
  if (!arguments.keep_work) fs::remove_all(folder / "work");
  if (!arguments.verbosity.quiet) print(result, arguments);
  printFindings(diagnostics, arguments.verbosity);
}

}  // namespace lodeline
