// Compares the walls of a simulated dive with the simulator's exact surface: accuracy of the cloud,
// completeness of the visible surface, areas of cross-sections. Prints one table.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "lodeline/output/survey/map/dive_map.h"
#include "lodeline/output/walls/section/wall_sections.h"
#include "studies/walls/true_surface.h"

namespace {

using namespace lodeline;

struct Arguments {
  std::string recording, run, walls, scenario = "cave1_short";
  double from_s = 0.0, to_s = 1e9, spacing_m = 1.0;
  ScenarioChanges changes;
};

/// cloud.ply or mesh.ply as `lodeline walls` writes it.
WallMesh readWallsPly(const std::filesystem::path& file) {
  constexpr size_t kVertexBytes = 31, kFaceBytes = 13;
  std::ifstream stream(file, std::ios::binary);
  std::string line;
  size_t vertices = 0, faces = 0;
  while (std::getline(stream, line) && line != "end_header") {
    if (line.starts_with("element vertex ")) vertices = std::stoull(line.substr(15));
    if (line.starts_with("element face ")) faces = std::stoull(line.substr(13));
  }
  std::vector<char> bytes(kVertexBytes * vertices + kFaceBytes * faces);
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (!stream || vertices == 0) throw InputError(file.string() + ": no walls of `lodeline walls`");
  WallMesh mesh;
  mesh.positions.resize(vertices);
  for (size_t i = 0; i < vertices; ++i)
    std::memcpy(mesh.positions[i].data(), bytes.data() + kVertexBytes * i, 3 * sizeof(float));
  mesh.triangles.resize(faces);
  for (size_t i = 0; i < faces; ++i) {
    const char* face = bytes.data() + kVertexBytes * vertices + kFaceBytes * i;
    std::memcpy(mesh.triangles[i].data(), face + 1, 3 * sizeof(uint32_t));
  }
  return mesh;
}

std::vector<Vec3> readCloud(const std::filesystem::path& file) {
  const WallMesh mesh = readWallsPly(file);
  std::vector<Vec3> points;
  for (const WallMesh::Point& point : mesh.positions) points.emplace_back(point.cast<double>());
  return points;
}

/// Points of points3D.txt as COLMAP writes it: rows of number, x, y, z and more.
std::vector<Vec3> readColmapPoints(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::vector<Vec3> points;
  while (std::getline(stream, line)) {
    std::istringstream row(line);
    double number = 0.0;
    Vec3 point;
    if (row >> number >> point.x() >> point.y() >> point.z()) points.push_back(point);
  }
  if (points.empty()) throw InputError(file.string() + ": no points of COLMAP");
  return points;
}

/// Poses of the part of the run that `--from` and `--to` choose, as `lodeline walls` counts it.
Trajectory partOf(const Trajectory& true_poses, Time begin, const Arguments& arguments) {
  Trajectory part = true_poses;
  std::erase_if(part.poses, [&](const StampedPose& pose) {
    const double since_s = (pose.time - begin).seconds();
    return since_s < arguments.from_s || since_s > arguments.to_s;
  });
  return part;
}

double shareWithin(const std::vector<double>& errors_m, double limit_m) {
  const auto within = std::count_if(errors_m.begin(), errors_m.end(), [&](double e) { return e <= limit_m; });
  return 100.0 * static_cast<double>(within) / static_cast<double>(std::max<size_t>(1, errors_m.size()));
}

void printErrors(const char* what, std::vector<double> errors_m) {
  std::sort(errors_m.begin(), errors_m.end());
  fmt::print("{:<32}{:>8.1f}{:>8.1f}{:>8.1f}{:>8.1f}{:>8.1f}{:>12.1f}{:>10}\n", what,
             shareWithin(errors_m, 0.02), shareWithin(errors_m, 0.04), shareWithin(errors_m, 0.05),
             shareWithin(errors_m, 0.08), shareWithin(errors_m, 0.10), 100.0 * quantile(errors_m, 0.9),
             errors_m.size());
}

/// Sections at the stations of the survey, as `lodeline walls` cuts them.
std::vector<StationWalls> sectionsOf(const WallMesh& mesh, const DiveMap& map) {
  const SectionOptions options;
  std::vector<StationWalls> walls;
  for (const PassageSection& section : passageSections(map.survey.stations)) {
    StationWalls& wall = walls.emplace_back();
    wall.across = planeAcross(section);
    cutMesh(mesh, wall.across, options.reach_m, &wall.lines);
    wall.outline = outlineOf(wall.lines, options);
  }
  return walls;
}

/// Prints median and largest of the sizes of errors in per cent.
void printAreaErrors(const char* what, std::vector<double> errors, size_t stations) {
  for (double& error : errors) error = std::abs(error);
  std::sort(errors.begin(), errors.end());
  if (errors.empty()) return fmt::print("{}: none of {} stations\n", what, stations);
  fmt::print("{}: {} of {} stations, error: median {:.1f} %, largest {:.1f} %\n", what, errors.size(),
             stations, quantile(errors, 0.5), errors.back());
}

/// Areas of the sections against the true ones: of closed sections as a whole, and of the seen sectors of all
/// sections with walls in at least `kLeastShare` of the directions.
void printAreas(const std::vector<StationWalls>& walls, const TrueSurface& truth,
                const Rigid3& truth_from_map) {
  constexpr double kLeastShare = 0.2;
  std::vector<double> closed, seen;
  for (size_t i = 0; i < walls.size(); ++i) {
    const SectionOutline& outline = walls[i].outline;
    if (outline.coverage < kLeastShare) continue;
    const std::vector<double> areas =
        truth.sectorAreas_m2(truth_from_map, walls[i].across, outline.radii_m.size());
    double true_m2 = 0.0, true_seen_m2 = 0.0;
    for (size_t k = 0; k < areas.size(); ++k) {
      true_m2 += areas[k];
      if (outline.radii_m[k]) true_seen_m2 += areas[k];
    }
    seen.push_back(100.0 * (outline.seen_area_m2 / true_seen_m2 - 1.0));
    fmt::print("section {:>3}: walls in {:3.0f} % of the directions, {:6.2f} m2 seen, {:+5.1f} %", i,
               100.0 * outline.coverage, outline.seen_area_m2, seen.back());
    if (outline.area_m2) {
      closed.push_back(100.0 * (*outline.area_m2 / true_m2 - 1.0));
      fmt::print("; closed: {:6.2f} m2, {:+5.1f} %", *outline.area_m2, closed.back());
    }
    fmt::print("\n");
  }
  printAreaErrors("closed sections", closed, walls.size());
  printAreaErrors("seen sectors", seen, walls.size());
}

void printCost(const std::filesystem::path& file) {
  const nlohmann::json json = nlohmann::json::parse(std::ifstream(file));
  const double frames = json["keyframes"], dive_s = json["dive_s"], processor_s = json["processor_s"];
  double work_s = 0.0;
  for (const auto& stage : json["seconds"]) work_s += stage.get<double>();
  fmt::print(
      "cost: {:.0f} core-ms a keyframe, {:.2f} x real time in core time, {:.2f} on the clock; {:.0f} MB\n",
      1e3 * processor_s / frames, processor_s / dive_s, work_s / dive_s,
      json["peak_memory_MB"].get<double>());
}

void study(const Arguments& arguments) {
  const Scenario scenario = makeScenario(arguments.scenario, arguments.changes);
  if (!holdsRecording(scenario, arguments.recording))
    throw InputError(arguments.recording + ": another scenario; give the options of `lodeline simulate`");
  Diagnostics diagnostics;
  DiveMapOptions options;
  options.stations.spacing_m = arguments.spacing_m;
  const DiveMap map = makeDiveMap(readRunFolder(arguments.run, &diagnostics), options, {}, &diagnostics);
  const Trajectory true_poses = readTrajectory(arguments.recording, {}, diagnostics);
  const PosePairs pairs = associate(map.trajectory, true_poses, {AssociationMethod::Interpolate, 0.1, 0.0});
  // The vertical is part of the map: a turn about a straight dive would not show in its positions.
  const Rigid3 truth_from_map = align(AlignmentType::Yaw, pairs).reference_from_estimate;
  double squares = 0.0;
  for (size_t i = 0; i < pairs.size(); ++i)
    squares +=
        (truth_from_map * pairs.estimate[i].translation - pairs.reference[i].translation).squaredNorm();
  fmt::print("trajectory: {:.1f} cm RMS from the truth after alignment\n",
             100.0 * std::sqrt(squares / static_cast<double>(pairs.size())));

  const TrueSurface truth(scenario);
  const std::filesystem::path walls = arguments.walls;
  const bool is_colmap = walls.extension() == ".txt";
  std::vector<Vec3> cloud = is_colmap ? readColmapPoints(walls) : readCloud(walls / "cloud.ply");
  for (Vec3& point : cloud) point = truth_from_map * point;
  fmt::print("{:<32}{:>8}{:>8}{:>8}{:>8}{:>8}{:>12}{:>10}\n", "share (%) within", "2 cm", "4 cm", "5 cm",
             "8 cm", "10 cm", "90 % in cm", "points");
  printErrors("cloud from the true surface", truth.distances_m(cloud, 20'000));
  const Trajectory part = partOf(true_poses, map.trajectory.poses.front().time, arguments);
  const Trajectory clear = truth.withoutSilt(part);
  std::vector<double> behind = truth.behind_m(cloud, part, 20'000);
  std::sort(behind.begin(), behind.end());
  fmt::print("behind the surface: quartiles {:+.1f}, {:+.1f}, {:+.1f} cm\n", 100.0 * quantile(behind, 0.25),
             100.0 * quantile(behind, 0.5), 100.0 * quantile(behind, 0.75));
  for (const double reach_m : {3.0, 4.0, 5.0}) {
    const std::vector<Vec3> visible = truth.visible(part, reach_m);
    printErrors(fmt::format("visible surface within {:.0f} m", reach_m).c_str(), nearest_m(cloud, visible));
    if (clear.size() < part.size())
      printErrors("  outside of silt-outs", nearest_m(cloud, truth.visible(clear, reach_m)));
  }
  if (is_colmap) return;
  printAreas(sectionsOf(readWallsPly(walls / "mesh.ply"), map), truth, truth_from_map);
  printCost(walls / "walls.json");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App program("Compares the walls of a simulated dive with the true surface");
  Arguments arguments;
  program.add_option("RECORDING", arguments.recording)->required();
  program.add_option("RUN", arguments.run)->required();
  program.add_option("WALLS", arguments.walls, "of `lodeline walls`, or points3D.txt of COLMAP")->required();
  program.add_option("--from", arguments.from_s, "s of the run, as for `lodeline walls`");
  program.add_option("--to", arguments.to_s);
  program.add_option("--spacing", arguments.spacing_m, "m between the stations, as for `lodeline walls`");
  program.add_option("--scenario", arguments.scenario);
  program.add_option("--realism", arguments.changes.realism);
  program.add_option("--metres", arguments.changes.metres);
  program.add_option("--seconds", arguments.changes.seconds);
  program.add_option("--seed", arguments.changes.seed);
  program.add_option("--camera-rate-hz", arguments.changes.camera_rate_hz);
  program.add_option("--cameras", arguments.changes.cameras);
  CLI11_PARSE(program, argc, argv);
  try {
    study(arguments);
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}\n", error.what());
    return 1;
  }
}
