// Measures what each error of a rig costs the estimator and what it claims, on dives of points: the effects
// of the simulator that need no images, each alone and all together. Prints the table of
// docs/lab-notes/effects.md.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "lodeline/estimator/estimator.h"
#include "lodeline/estimator/magnetometer/heading_alignment.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/trajectory.h"
#include "lodeline/util/angles.h"
#include "lodeline/util/median.h"
#include "simulation/dive/point_dive.h"

namespace {

using namespace lodeline;

/// Effects that act on a dive of `realism`.
struct Case {
  const char* name;
  const char* realism;
  std::vector<std::string> effects;
};

const std::vector<Case> kCases = {
    {"clean", "clean", {}},
    {"camera_intrinsics", "clean", {"camera_intrinsics=on"}},
    {"camera_imu_extrinsics", "clean", {"camera_imu_extrinsics=on"}},
    {"stereo_extrinsics", "clean", {"stereo_extrinsics=on"}},
    {"flat_port", "clean", {"flat_port=on"}},
    {"port_tilt", "clean", {"flat_port=on", "port_tilt=on"}},
    {"dome_port", "clean", {"dome_port=on"}},
    {"imu_scale", "clean", {"imu_scale=on"}},
    {"imu_warm_up", "clean", {"imu_warm_up=on"}},
    {"g_sensitivity", "clean", {"g_sensitivity=on"}},
    {"dropped_frames", "clean", {"dropped_frames=on"}},
    {"hard_iron_creep", "clean", {"hard_iron_creep=on"}},
    {"magnetic_disturbances", "clean", {"magnetic_disturbances=on"}},
    {"magnetometer_lag", "clean", {"magnetometer_lag=on"}},
    {"field", "field", {}},
    {"all", "physical", {}},
    {"all, dome", "physical", {"dome_port=on"}},
};

struct Study {
  std::string scenario = "demo", imu = "gx5-25";
  double seconds = 60.0, metres = 0.0, rate_hz = 6.0;
  int tracks = 60, cameras = 2;
  MagnetometerUse use = MagnetometerUse::Off;
};

/// Errors and claimed sigmas of all poses, from the first pose on.
struct Errors {
  std::vector<double> position_m, position_sigma_m, heading_rad, heading_sigma_rad;
  std::vector<double> ends_m, ends_rad;
  std::vector<double> scales;  ///< relative scale errors after Sim3 alignment, one per dive
  std::vector<double>
      shares_of_paths;  ///< root mean square of the positions after SE3 alignment over the path
  int lost = 0;         ///< dives without a start

  /// `north_of_truth_rad`: azimuth of the world of the truth in one that points to magnetic north. Without a
  /// magnetometer headings count from the first pose.
  void add(const Rigid3& truth_from_first, const Rigid3& first, const Rigid3& truth,
           double north_of_truth_rad, const FrameEstimate& estimate) {
    const Rigid3& pose = estimate.state.world_from_body;
    const double turned_rad = so3::log(pose.rotation * truth.rotation.conjugate()).z();
    const double at_first_rad = so3::log(first.rotation * truth_from_first.rotation.conjugate()).z();
    const Quat turn = so3::exp(at_first_rad * Vec3::UnitZ());
    const Vec3 expected_W = turn * (truth.translation - truth_from_first.translation);
    position_m.push_back((pose.translation - first.translation - expected_W).norm());
    const auto& north_rad = estimate.sensors.of<MagnetometerEstimate>().north_from_world_rad;
    const double reference_rad = north_rad ? north_of_truth_rad - *north_rad : at_first_rad;
    heading_rad.push_back(std::abs(std::remainder(turned_rad - reference_rad, 2.0 * std::numbers::pi)));
    position_sigma_m.push_back(std::sqrt(estimate.covariance.topLeftCorner<3, 3>().trace()));
    heading_sigma_rad.push_back(std::sqrt(estimate.covariance(5, 5)));
  }
};

/// Length of the way through all poses, m.
double pathOf_m(const std::vector<Rigid3>& poses) {
  double path_m = 0.0;
  for (size_t i = 1; i < poses.size(); ++i)
    path_m += (poses[i].translation - poses[i - 1].translation).norm();
  return path_m;
}

void addAlignedErrors(const PosePairs& pairs, Errors* errors) {
  errors->ends_m.push_back(errors->position_m.back());
  errors->ends_rad.push_back(errors->heading_rad.back());
  errors->scales.push_back(align(AlignmentType::Sim3, pairs).scaleError());
  const std::vector<Rigid3> aligned = applyAlignment(align(AlignmentType::SE3, pairs), pairs.estimate);
  double squares_m2 = 0.0;
  for (size_t i = 0; i < aligned.size(); ++i)
    squares_m2 += (aligned[i].translation - pairs.reference[i].translation).squaredNorm();
  errors->shares_of_paths.push_back(std::sqrt(squares_m2 / static_cast<double>(aligned.size())) /
                                    pathOf_m(pairs.reference));
}

ScenarioChanges changesOf(const Study& study, const Case& which, uint64_t seed) {
  ScenarioChanges changes;
  changes.seed = seed;
  changes.seconds = study.seconds;
  if (study.metres > 0.0) changes.metres = study.metres;
  changes.cameras = study.cameras;
  changes.imu_grade = study.imu;
  changes.realism = which.realism;
  changes.effects = which.effects;
  return changes;
}

/// The files' rig with a calibrated magnetometer, whose rotation a calibration finds.
Rig calibratedRig(const Dive& dive) {
  Rig rig = dive.errors.given;
  const MagnetometerErrors& errors = dive.errors.magnetometer;
  rig.magnetometer->body_from_magnetometer = errors.body_from_magnetometer;
  rig.magnetometer->iron_correction = errors.soft_iron.inverse();
  rig.magnetometer->hard_iron_T = errors.hard_iron_T;
  rig.magnetometer->hard_iron_sigma_T = 0.05e-6;
  rig.magnetometer->is_calibrated = true;
  return rig;
}

void addDive(const Study& study, const Case& which, uint64_t seed, Errors* errors) {
  ScenarioChanges changes = changesOf(study, which, seed);
  const Dive dive = makeDive(makeScenario(study.scenario, changes));
  // The same dive, with the exact port in front of the cameras in place of the lens that fits best.
  changes.effects.push_back("port_in_files=on");
  const Rig true_rig = makeDive(makeScenario(study.scenario, changes)).errors.in_water;
  const LandmarkField landmarks = diveLandmarks(dive);
  PointSimulationOptions points;
  points.seed = seed;
  points.start = dive.start;
  points.frame_rate_hz = study.rate_hz;
  points.tracks = study.tracks;
  points.outlier_share = 0.02;
  points.dropped_frame_share = dive.errors.dropped_image_share;
  points.imu = dive.errors.imu;
  points.magnetometer = {dive.field_W, dive.disturbances, dive.errors.magnetometer};
  points.gravity_W = dive.gravity_W;
  const Rig given = calibratedRig(dive);
  PointSimulation simulation(dive.motion, landmarks, true_rig, given, points);
  EstimatorOptions options;
  options.magnetometer.use = study.use;
  Diagnostics findings;
  Estimator estimator(given, options, &findings);
  const double north_of_truth_rad =
      northFromWorld(dive.field_W, HeadingReference::Magnetic, options.magnetometer);
  PosePairs pairs;
  while (const std::optional<SimulatedFrame> frame = simulation.next()) {
    const FrameEstimate estimate =
        estimator.add(frame->tracks, frame->imu, SensorReadings(frame->magnetometer));
    if (estimate.status == Status::Waiting) continue;
    const Rigid3& truth = frame->truth.motion.world_from_body;
    pairs.time.push_back(estimate.time);
    pairs.estimate.push_back(estimate.state.world_from_body);
    pairs.reference.push_back(truth);
    errors->add(pairs.reference.front(), pairs.estimate.front(), truth, north_of_truth_rad, estimate);
  }
  if (pairs.size() == 0) {
    ++errors->lost;
  } else {
    addAlignedErrors(pairs, errors);
  }
}

double withinThreeSigmas_percent(const std::vector<double>& errors, const std::vector<double>& sigmas) {
  size_t count = 0;
  for (size_t i = 0; i < errors.size(); ++i) count += errors[i] <= 3.0 * sigmas[i];
  return 100.0 * static_cast<double>(count) / static_cast<double>(std::max<size_t>(1, errors.size()));
}

double rms(const std::vector<double>& values) {
  double squares = 0.0;
  for (const double value : values) squares += value * value;
  return std::sqrt(squares / static_cast<double>(std::max<size_t>(1, values.size())));
}

void print(const Case& which, const Study& study, const Errors& errors) {
  fmt::print("| {} | {} | {:.3f} | {:.3f} | {:.3f} | {:.3f} | {:.1f} | {:.1f} | {:.2f} | {:.2f} | {} |\n",
             which.name, study.cameras, rms(errors.ends_m), rms(errors.ends_rad) * kDegreesPerRadian,
             100.0 * rms(errors.scales), 100.0 * rms(errors.shares_of_paths),
             withinThreeSigmas_percent(errors.position_m, errors.position_sigma_m),
             withinThreeSigmas_percent(errors.heading_rad, errors.heading_sigma_rad),
             median(errors.position_sigma_m) / median(errors.position_m),
             median(errors.heading_sigma_rad) / median(errors.heading_rad), errors.lost);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Errors at the end of dives of points, of scale, and of aligned positions over the path (root mean "
      "square over seeds), share of all poses within three claimed sigmas, and median sigma over median "
      "error, with each error of the rig alone and all together.");
  Study study;
  int seeds = 10;
  uint64_t first_seed = 4001;
  std::vector<std::string> only;
  std::string use = "off";
  app.add_option("--seeds", seeds)->capture_default_str();
  app.add_option("--first-seed", first_seed)->capture_default_str();
  app.add_option("--scenario", study.scenario)->capture_default_str();
  app.add_option("--seconds", study.seconds)->capture_default_str();
  app.add_option("--metres", study.metres, "length of the path; that of the scenario by default");
  app.add_option("--rate", study.rate_hz, "frames a second")->capture_default_str();
  app.add_option("--tracks", study.tracks)->capture_default_str();
  app.add_option("--cameras", study.cameras)->capture_default_str()->check(CLI::Range(1, 2));
  app.add_option("--imu", study.imu)->capture_default_str();
  app.add_option("--use", use, "of the magnetometer")
      ->capture_default_str()
      ->check(CLI::IsMember({"off", "absolute"}));
  app.add_option("--only", only, "names of effects; all by default");
  CLI11_PARSE(app, argc, argv);
  study.use = use == "off" ? MagnetometerUse::Off : MagnetometerUse::Absolute;
  fmt::print(
      "| effect | cameras | end, m | heading at the end, ° | scale, % | position, % of the path | position "
      "within 3 σ, % | heading within 3 σ, % "
      "| "
      "σ / error, position | σ / error, heading | dives without a start |\n"
      "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
  for (const Case& which : kCases) {
    if (!only.empty() && std::find(only.begin(), only.end(), which.name) == only.end()) continue;
    Errors errors;
    for (int i = 0; i < seeds; ++i) addDive(study, which, first_seed + static_cast<uint64_t>(i), &errors);
    print(which, study, errors);
  }
  return 0;
}
