// Measures what loops are worth on circuits of points that are swum twice, with the errors of `field`:
// position errors of the odometry, the causal map trajectory and the batch solution without and with loops.
// Prints the table of docs/lab-notes/slam.md.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <string>
#include <vector>

#include "lodeline/batch/refine.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/session/test_mapped_dive.h"
#include "simulation/dive/dive.h"
#include "simulation/dive/dive_world.h"

namespace {

using namespace lodeline;

struct Study {
  double metres = 300.0, seconds = 900.0;  ///< both laps
  int tracks = 90;
  double rate_hz = 4.0;
  double sight_m = 3.5;  ///< distance to which points are seen
  bool with_batch = true;
  std::filesystem::path folder;
};

/// The files' rig with a magnetometer that a calibration has found to 0.05 uT and 0.1 degrees.
Rig calibratedRig(const Dive& dive) {
  Rig rig = dive.errors.given;
  const MagnetometerErrors& errors = dive.errors.magnetometer;
  Random random(dive.scenario.seed, "loops_study/calibration");
  constexpr double kIron_T = 0.05e-6, kTurn_rad = 0.1 * M_PI / 180.0;
  MagnetometerCalibration& magnetometer = *rig.magnetometer;
  magnetometer.body_from_magnetometer = errors.body_from_magnetometer;
  magnetometer.body_from_magnetometer.rotation =
      errors.body_from_magnetometer.rotation * so3::exp(kTurn_rad * random.normal3());
  magnetometer.iron_correction = errors.soft_iron.inverse();
  magnetometer.hard_iron_T = errors.hard_iron_T + kIron_T * random.normal3();
  magnetometer.hard_iron_sigma_T = kIron_T;
  magnetometer.rotation_sigma_rad = kTurn_rad;
  magnetometer.is_calibrated = true;
  return rig;
}

MappedScene sceneOf(const Study& study, uint64_t seed) {
  ScenarioChanges changes;
  changes.seed = seed;
  changes.metres = study.metres;
  changes.seconds = study.seconds;
  changes.realism = "field";
  Dive dive = makeDive(makeScenario("loop_cave", changes));
  // Points pass the exact port in front of the cameras; the files have the lens that fits best.
  changes.effects.push_back("port_in_files=on");
  const Rig true_rig = makeDive(makeScenario("loop_cave", changes)).errors.in_water;
  PointSimulationOptions points;
  points.seed = seed;
  points.start = dive.start;
  points.frame_rate_hz = study.rate_hz;
  points.tracks = study.tracks;
  points.outlier_share = 0.02;
  points.farthest_m = study.sight_m;
  points.dropped_frame_share = dive.errors.dropped_image_share;
  points.imu = dive.errors.imu;
  points.magnetometer = {dive.field_W, dive.disturbances, dive.errors.magnetometer};
  points.gravity_W = dive.gravity_W;
  for (const SiltEpisode& silt : renderSettings(dive).water.silt)
    points.blackouts.push_back({silt.start_s, silt.duration_s});
  LandmarkField landmarks = diveLandmarks(dive);
  const Vec3 origin_W = dive.cave->origin_W;
  Rig given = calibratedRig(dive);
  return {std::move(dive.motion), std::move(landmarks), true_rig, std::move(given), points, origin_W};
}

/// Root mean square of the position errors after the first loop, m.
struct PositionErrors {
  double from_start_m = 0.0;  ///< azimuth and position agree over the first 40 s
  double aligned_m = 0.0;     ///< azimuth and position agree over the whole dive
};

/// Shifts and turns `poses` about the vertical so that those of the first `count` agree best with the truth.
/// Returns the errors of all positions.
std::vector<double> errorsAfterAlignment(const std::vector<Vec3>& positions, const std::vector<Rigid3>& truth,
                                         size_t count) {
  Vec3 mean = Vec3::Zero(), true_mean = Vec3::Zero();
  for (size_t i = 0; i < count; ++i) {
    mean += positions[i] / static_cast<double>(count);
    true_mean += truth[i].translation / static_cast<double>(count);
  }
  double cosine = 0.0, sine = 0.0;
  for (size_t i = 0; i < count; ++i) {
    const Vec3 a = positions[i] - mean, b = truth[i].translation - true_mean;
    cosine += a.head<2>().dot(b.head<2>());
    sine += a.x() * b.y() - a.y() * b.x();
  }
  const Quat turn = so3::exp(std::atan2(sine, cosine) * Vec3::UnitZ());
  std::vector<double> errors_m;
  for (size_t i = 0; i < positions.size(); ++i)
    errors_m.push_back((turn * (positions[i] - mean) - (truth[i].translation - true_mean)).norm());
  return errors_m;
}

double rmsFrom(const std::vector<double>& errors_m, size_t first) {
  double squares = 0.0;
  for (size_t i = first; i < errors_m.size(); ++i) squares += errors_m[i] * errors_m[i];
  return std::sqrt(squares / static_cast<double>(std::max<size_t>(1, errors_m.size() - first)));
}

PositionErrors errorsOf(const MappedDive& dive, const std::vector<Vec3>& positions) {
  constexpr double kStart_s = 40.0;
  const auto frameAt = [&](Time time) {
    return static_cast<size_t>(std::lower_bound(dive.times.begin(), dive.times.end(), time) -
                               dive.times.begin());
  };
  const size_t first = dive.first_loop ? frameAt(*dive.first_loop) : 0;
  const size_t start = frameAt(dive.times.front() + Duration::fromSeconds(kStart_s));
  return {rmsFrom(errorsAfterAlignment(positions, dive.truth, start), first),
          rmsFrom(errorsAfterAlignment(positions, dive.truth, positions.size()), first)};
}

std::vector<Vec3> positionsOf(const std::vector<Rigid3>& poses) {
  std::vector<Vec3> positions;
  for (const Rigid3& pose : poses) positions.push_back(pose.translation);
  return positions;
}

std::vector<Vec3> positionsOf(const std::vector<FrameEstimate>& frames) {
  std::vector<Vec3> positions;
  for (const FrameEstimate& frame : frames) positions.push_back(frame.state.world_from_body.translation);
  return positions;
}

void printRatio(const PositionErrors& without, const PositionErrors& with) {
  fmt::print(" {:.3f} / {:.3f} = {:.2f} | {:.3f} / {:.3f} = {:.2f} |", with.from_start_m,
             without.from_start_m, with.from_start_m / without.from_start_m, with.aligned_m,
             without.aligned_m, with.aligned_m / without.aligned_m);
  std::fflush(stdout);
}

void run(const Study& study, uint64_t seed, MagnetometerUse use) {
  MappedDiveOptions options;
  options.cave.seed = seed;
  options.dive_seed = seed;
  options.estimator.magnetometer.use = use;
  const auto file = study.folder / fmt::format("loops_{}_{}.db", seed, static_cast<int>(use));
  for (const char* suffix : {"", "-wal", "-shm"}) std::filesystem::remove(file.string() + suffix);
  const MappedDive dive(sceneOf(study, seed), options, file, nullptr);
  const double worst_m = dive.loop_errors_m.empty()
                             ? 0.0
                             : *std::max_element(dive.loop_errors_m.begin(), dive.loop_errors_m.end());
  const double nees = std::accumulate(dive.loop_errors_squared.begin(), dive.loop_errors_squared.end(), 0.0) /
                      static_cast<double>(std::max<size_t>(1, dive.loop_errors_squared.size()));
  fmt::print("| {} | {} | {} | {:.2f} | {:.1f} |", seed, use == MagnetometerUse::Off ? "off" : "calibrated",
             dive.loop_errors_m.size(), worst_m, nees);
  const PositionErrors odometry = errorsOf(dive, positionsOf(dive.odometry));
  printRatio(odometry, errorsOf(dive, positionsOf(dive.in_map)));
  if (study.with_batch) {
    const Refinement without = refine(dive.rig, dive.options, dive.record);
    const Refinement with = refine(dive.rig, dive.options, dive.record, dive.closures);
    printRatio(errorsOf(dive, positionsOf(without.frames)), errorsOf(dive, positionsOf(with.frames)));
    for (const Refinement* refinement : {&without, &with})
      if (!refinement->summary.usable()) fmt::print(" {}", refinement->summary.refusal);
  }
  fmt::print("\n");
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Position errors (m) after the first loop of circuits that are swum twice, with loops / without. First "
      "with poses aligned by the first 40 s, then over the whole dive.");
  Study study;
  int seeds = 3;
  uint64_t first_seed = 1;
  std::string use = "both";
  bool no_batch = false;
  study.folder = std::filesystem::temp_directory_path();
  app.add_option("--seeds", seeds)->capture_default_str();
  app.add_option("--first-seed", first_seed)->capture_default_str();
  app.add_option("--metres", study.metres, "of both laps")->capture_default_str();
  app.add_option("--seconds", study.seconds)->capture_default_str();
  app.add_option("--rate", study.rate_hz, "frames a second")->capture_default_str();
  app.add_option("--tracks", study.tracks)->capture_default_str();
  app.add_option("--sight", study.sight_m, "distance to which points are seen, m")->capture_default_str();
  app.add_option("--magnetometer", use)
      ->capture_default_str()
      ->check(CLI::IsMember({"off", "calibrated", "both"}));
  app.add_option("--folder", study.folder, "for the maps")->capture_default_str();
  app.add_flag("--no-batch", no_batch, "causal trajectories alone");
  CLI11_PARSE(app, argc, argv);
  study.with_batch = !no_batch;
  fmt::print(
      "| seed | magnetometer | loops | worst, m | NEES, of 6 | map / odometry, start | map / odometry, "
      "aligned | batch with / without loops, start | batch, aligned |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  for (int i = 0; i < seeds; ++i) {
    const uint64_t seed = first_seed + static_cast<uint64_t>(i);
    if (use != "calibrated") run(study, seed, MagnetometerUse::Off);
    if (use != "off") run(study, seed, MagnetometerUse::Absolute);
  }
  return 0;
}
