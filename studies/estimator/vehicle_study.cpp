// Errors and consistency of the estimator on dives of a vehicle, with points in place of images. Prints the
// tables of docs/lab-notes/vehicle.md.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lodeline/estimator/trials/consistency.h"
#include "lodeline/util/angles.h"
#include "simulation/dive/dive_errors.h"
#include "simulation/dive/point_dive.h"
#include "simulation/sensors/pressure_model.h"

namespace {

using namespace lodeline;

struct Figures {
  double position_rms_m = 0.0, end_error_m = 0.0, path_m = 0.0, yaw_rms_rad = 0.0;
  double dark_drift_m = 0.0, aligned_rms_m = 0.0;
  double position_nees = 0.0, yaw_nees = 0.0, velocity_nees = 0.0;
  int frames = 0;
};

struct Study {
  std::string scenario = "auv", realism = "clean";
  std::vector<std::string> effects;
  double metres = 40.0, imu_rate_hz = 200.0, frame_rate_hz = 8.0;
  int tracks = 60;
  std::vector<double> dark;  ///< begin and duration, s
  bool uses_pressure = false;
  EstimatorOptions estimator;
};

/// Root mean square distance of two paths after the best translation and rotation about the vertical. With a
/// magnetometer, the heading of the start is that of its first readings, and no error of the dive.
double alignedRms_m(const std::vector<Vec3>& estimated, const std::vector<Vec3>& truth) {
  Vec3 mean_estimated = Vec3::Zero(), mean_truth = Vec3::Zero();
  const auto count = static_cast<double>(estimated.size());
  for (size_t i = 0; i < estimated.size(); ++i) {
    mean_estimated += estimated[i] / count;
    mean_truth += truth[i] / count;
  }
  double along = 0.0, across = 0.0, squares = 0.0;
  for (size_t i = 0; i < estimated.size(); ++i) {
    const Vec3 a = truth[i] - mean_truth, b = estimated[i] - mean_estimated;
    along += a.x() * b.x() + a.y() * b.y();
    across += a.x() * b.y() - a.y() * b.x();
  }
  const Mat3 turn = Eigen::AngleAxisd(std::atan2(across, along), Vec3::UnitZ()).toRotationMatrix();
  for (size_t i = 0; i < estimated.size(); ++i)
    squares += (estimated[i] - mean_estimated - turn * (truth[i] - mean_truth)).squaredNorm();
  return std::sqrt(squares / std::max(count, 1.0));
}

SensorReadings readingsOf(const SimulatedFrame& frame, std::vector<DepthSample> depths) {
  return SensorReadings(frame.magnetometer, frame.dvl, frame.altimeter, frame.currents, std::move(depths));
}

/// The pressure sensor of a dive of points, as in a recording of the scenario.
class StudyGauge {
 public:
  explicit StudyGauge(const VehicleDive& vehicle)
      : start_(vehicle.dive.start),
        rate_hz_(vehicle.dive.scenario.rig.pressure_rate_hz),
        model_(vehicle.dive.motion, vehicle.trueRig().pressure.value().body_from_pressure,
               vehicle.dive.surface_height_m, vehicle.dive.errors.pressure, vehicle.options.seed) {}

  /// The readings since the last call, up to `end`.
  std::vector<DepthSample> until(Time end) {
    std::vector<DepthSample> samples;
    for (;; ++next_) {
      const double time_s = (static_cast<double>(next_) + 0.3) / rate_hz_;
      const Time time = start_ + Duration::fromSeconds(time_s);
      if (time > end) return samples;
      samples.push_back({time, model_.measure(time_s)});
    }
  }

 private:
  Time start_;
  double rate_hz_;
  PressureModel model_;
  int64_t next_ = 0;
};

/// The files' rig with a magnetometer and currents that were calibrated before the dive.
Rig calibratedRig(const VehicleDive& dive) {
  Rig rig = dive.givenRig();
  const MagnetometerErrors& errors = dive.options.magnetometer->errors;
  rig.magnetometer->noise_density_T_per_sqrtHz = errors.noise_density_T_per_sqrtHz;
  rig.magnetometer->body_from_magnetometer = errors.body_from_magnetometer;
  rig.magnetometer->iron_correction = errors.soft_iron.inverse();
  rig.magnetometer->hard_iron_T = errors.hard_iron_T;
  rig.magnetometer->hard_iron_sigma_T = 0.01e-6;
  rig.magnetometer->is_calibrated = true;
  rig.currents->fields_T_per_A = dive.trueRig().currents->fields_T_per_A;
  rig.currents->field_sigma_T_per_A = 5e-9;
  return rig;
}

Figures run(const Study& study, uint64_t seed, Diagnostics* diagnostics) {
  ScenarioChanges changes;
  changes.seed = seed;
  changes.metres = study.metres;
  changes.realism = study.realism;
  changes.effects = study.effects;
  changes.imu_rate_hz = study.imu_rate_hz;
  const VehicleDive dive = makeVehicleDive(makeScenario(study.scenario, changes));
  PointSimulationOptions options = dive.options;
  options.frame_rate_hz = study.frame_rate_hz;
  options.tracks = study.tracks;
  if (study.dark.size() == 2) options.blackouts = {{study.dark[0], study.dark[1]}};
  PointSimulation simulation = dive.simulate(options);
  EstimatorOptions estimator_options = study.estimator;
  estimator_options.magnetometer.site_field_W = dive.options.magnetometer->field_W;
  Estimator estimator(calibratedRig(dive), estimator_options, diagnostics);
  std::optional<StudyGauge> gauge;
  if (study.uses_pressure) gauge.emplace(dive);
  TruthComparison truth;
  Figures figures;
  std::optional<Vec3> last, at_dusk;
  std::vector<Vec3> estimated, truth_W;
  while (const auto frame = simulation.next()) {
    std::vector<DepthSample> depths;
    if (gauge) depths = gauge->until(frame->truth.time);
    const FrameEstimate estimate =
        estimator.add(frame->tracks, frame->imu, readingsOf(*frame, std::move(depths)));
    const Comparison comparison = truth.compare(*frame, estimate, estimator);
    const Vec3& place_W = frame->truth.motion.world_from_body.translation;
    if (last) figures.path_m += (place_W - *last).norm();
    last = place_W;
    if (!comparison.initialized()) continue;
    estimated.push_back(comparison.estimate.state.world_from_body.translation);
    truth_W.push_back(place_W);
    const NeesSample nees = neesOf(comparison);
    ++figures.frames;
    figures.position_rms_m += comparison.error.head<3>().squaredNorm();
    figures.yaw_rms_rad += nees.yaw_error_rad * nees.yaw_error_rad;
    figures.position_nees += nees.position;
    figures.yaw_nees += nees.yaw;
    figures.velocity_nees += nees.velocity;
    figures.end_error_m = comparison.positionError();
    const double time_s = (frame->truth.time - options.start).seconds();
    if (study.dark.size() != 2 || time_s > study.dark[0] + study.dark[1]) continue;
    if (time_s < study.dark[0]) at_dusk = comparison.error.head<3>();
    if (at_dusk) figures.dark_drift_m = (comparison.error.head<3>() - *at_dusk).norm();
  }
  figures.aligned_rms_m = alignedRms_m(estimated, truth_W);
  const double count = std::max(figures.frames, 1);
  figures.position_rms_m = std::sqrt(figures.position_rms_m / count);
  figures.yaw_rms_rad = std::sqrt(figures.yaw_rms_rad / count);
  for (double* sum : {&figures.position_nees, &figures.yaw_nees, &figures.velocity_nees}) *sum /= count;
  return figures;
}

void print(const std::string& name, const Figures& f) {
  fmt::print("{:>6} {:8.2f} {:10.4f} {:10.4f} {:10.4f} {:9.3f} {:8.3f} {:8.3f} {:8.2f} {:8.2f} {:8.2f}\n",
             name, f.path_m, f.position_rms_m, f.aligned_rms_m, f.end_error_m,
             100.0 * f.end_error_m / f.path_m, f.yaw_rms_rad * kDegreesPerRadian, f.dark_drift_m,
             f.position_nees, f.yaw_nees, f.velocity_nees);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Errors and mean NEES (3, 1 and 3 of a consistent estimator) over dives of a vehicle with points.");
  Study study;
  int seeds = 3;
  uint64_t first_seed = 1;
  bool magnetometer = true, dvl = true, findings = false;
  MotionNoiseOptions& motion_noise = study.estimator.preintegration.motion_noise;
  app.add_option("--scenario", study.scenario, "auv or wreck")->capture_default_str();
  app.add_option("--metres", study.metres)->capture_default_str();
  app.add_option("--realism", study.realism)->capture_default_str();
  app.add_option("--effect", study.effects, "name=on|off");
  app.add_option("--imu-rate", study.imu_rate_hz)->capture_default_str();
  app.add_option("--rate", study.frame_rate_hz, "frames a second")->capture_default_str();
  app.add_option("--tracks", study.tracks)->capture_default_str();
  app.add_option("--dark", study.dark, "begin and duration of darkness, s")->expected(2);
  app.add_option("--seeds", seeds)->capture_default_str();
  app.add_option("--first-seed", first_seed)->capture_default_str();
  app.add_option("--magnetometer", magnetometer)->capture_default_str();
  app.add_option("--dvl", dvl)->capture_default_str();
  app.add_option("--pressure", study.uses_pressure)->capture_default_str();
  app.add_option("--unresolved-share", motion_noise.unresolved_share)->capture_default_str();
  app.add_option("--inflation", study.estimator.preintegration.noise_inflation)->capture_default_str();
  app.add_flag("--findings", findings, "print the findings of every dive");
  CLI11_PARSE(app, argc, argv);
  if (!magnetometer) study.estimator.magnetometer.use = MagnetometerUse::Off;
  study.estimator.dvl.use = dvl;
  fmt::print("{:>6} {:>8} {:>10} {:>10} {:>10} {:>9} {:>8} {:>8} {:>8} {:>8} {:>8}\n", "seed", "path m",
             "rms m", "aligned m", "end m", "end %", "yaw deg", "dark m", "NEES p", "NEES yaw", "NEES v");
  Figures mean;
  for (int i = 0; i < seeds; ++i) {
    Diagnostics diagnostics;
    const Figures f = run(study, first_seed + static_cast<uint64_t>(i), &diagnostics);
    print(fmt::format("{}", first_seed + static_cast<uint64_t>(i)), f);
    if (findings) {
      for (const Finding& finding : diagnostics.ranked())
        fmt::print("         {} ({}): {}\n", finding.kind, finding.count, finding.first_message);
    }
    mean.position_rms_m += f.position_rms_m * f.position_rms_m / seeds;
    mean.yaw_rms_rad += f.yaw_rms_rad * f.yaw_rms_rad / seeds;
    for (double Figures::*figure :
         {&Figures::path_m, &Figures::aligned_rms_m, &Figures::end_error_m, &Figures::dark_drift_m,
          &Figures::position_nees, &Figures::yaw_nees, &Figures::velocity_nees})
      mean.*figure += f.*figure / seeds;
  }
  mean.position_rms_m = std::sqrt(mean.position_rms_m);
  mean.yaw_rms_rad = std::sqrt(mean.yaw_rms_rad);
  print("mean", mean);
  return 0;
}
