// Measures the heading error of a vehicle in laps around and through a steel wreck: simulated points,
// magnetometer off, on, and with the map of the field. Prints the table of docs/lab-notes/magnetic_map.md.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "lodeline/estimator/estimator.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/util/thread_clock.h"
#include "simulation/dive/point_dive.h"
#include "simulation/sensors/landmarks_along.h"

namespace {

using namespace lodeline;

constexpr double kDegrees = 180.0 / std::numbers::pi;

struct WreckRun {
  std::array<double, 3> sums{},
      squares{};  ///< of heading errors against the first heading, in thirds of the dive
  std::array<int, 3> counts{};
  double sigma_rad = 0.0, position_m = 0.0, estimator_s = 0.0;  ///< the first two at the end
  std::array<int, 10> by_status{};
  Diagnostics findings;

  /// Root mean square error of a third about `from_rad`.
  double rms_deg(size_t third, double from_rad = 0.0) const {
    const double mean = sums[third] / counts[third];
    return kDegrees * std::sqrt(squares[third] / counts[third] - mean * mean + std::pow(mean - from_rad, 2));
  }
  /// The same about the mean of the first third, in which a map is learnt.
  double drift_deg(size_t third) const { return rms_deg(third, sums[0] / counts[0]); }
};

/// The rig of the files with a right calibration of the magnetometer.
Rig calibratedRig(const VehicleDive& vehicle) {
  Rig rig = vehicle.givenRig();
  const MagnetometerErrors& errors = vehicle.options.magnetometer.value().errors;
  MagnetometerCalibration& calibration = rig.magnetometer.value();
  calibration.noise_density_T_per_sqrtHz = errors.noise_density_T_per_sqrtHz;
  calibration.body_from_magnetometer = errors.body_from_magnetometer;
  calibration.iron_correction = errors.soft_iron.inverse();
  calibration.hard_iron_T = errors.hard_iron_T;
  calibration.hard_iron_sigma_T = 0.01e-6;
  calibration.is_calibrated = true;
  rig.currents.reset();  // they have no field in this scenario
  return rig;
}

WreckRun runWreck(const VehicleDive& vehicle, const PointSimulationOptions& points,
                  const EstimatorOptions& options, double each_s) {
  WreckRun run;
  PointSimulation simulation = vehicle.simulate(points);
  Estimator estimator(calibratedRig(vehicle), options, &run.findings);
  const double end_s = std::min(points.end_s, vehicle.dive.motion.duration_s());
  std::optional<double> first_rad;
  Rigid3 truth_from_estimate;
  double next_s = 0.0;
  while (auto frame = simulation.next()) {
    const double time_s = (frame->truth.time - points.start).seconds();
    const SensorReadings readings(frame->magnetometer, frame->dvl, frame->altimeter, frame->currents);
    const double before_s = threadSeconds();
    const FrameEstimate estimate = estimator.add(frame->tracks, frame->imu, readings);
    run.estimator_s += threadSeconds() - before_s;
    if (estimate.status == Status::Waiting) continue;
    const Rigid3& estimated = estimate.state.world_from_body;
    const Rigid3& truth = frame->truth.motion.world_from_body;
    const double heading_rad = so3::log(estimated.rotation * truth.rotation.conjugate()).z();
    // The start is in the Earth's field, whose heading settles in some seconds.
    if (!first_rad && time_s > 20.0) {
      first_rad = heading_rad;
      truth_from_estimate = truth * estimated.inverse();
    }
    if (!first_rad) continue;
    const double error_rad = std::remainder(heading_rad - *first_rad, 2.0 * std::numbers::pi);
    const auto third = static_cast<size_t>(std::min(2.0, 3.0 * time_s / end_s));
    run.sums[third] += error_rad;
    run.squares[third] += error_rad * error_rad;
    ++run.counts[third];
    run.sigma_rad = std::sqrt(estimate.covariance(5, 5));
    run.position_m = ((truth_from_estimate * estimated).translation - truth.translation).norm();
    const auto status = estimate.sensors.of<MagnetometerEstimate>().status;
    ++run.by_status[static_cast<size_t>(status)];
    if (each_s > 0.0 && time_s >= next_s) {
      next_s = time_s + each_s;
      fmt::print("  {:7.1f} s {:8.3f} deg, position {:.2f} m, {}\n", time_s, kDegrees * error_rad,
                 run.position_m, toString(status));
    }
  }
  return run;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Heading errors of a vehicle at a steel wreck against the heading after 20 s, degrees: root mean "
      "square in "
      "each third of the dive; drift in thirds 2 and 3 from the mean of the first; sigma and position error "
      "at the "
      "end.");
  int seeds = 1, laps = 3;
  uint64_t first_seed = 1;
  double rate_hz = 4.0, each_s = 0.0, end_s = 1e9;
  int tracks = 60;
  bool uses_dvl = true, is_honest = true;
  std::vector<std::string> modes = {"off", "on", "map"};
  app.add_option("--seeds", seeds)->capture_default_str();
  app.add_option("--first-seed", first_seed)->capture_default_str();
  app.add_option("--laps", laps)->capture_default_str();
  app.add_option("--rate", rate_hz, "frames a second")->capture_default_str();
  app.add_option("--tracks", tracks)->capture_default_str();
  app.add_option("--end", end_s, "s, end of the dive");
  app.add_option("--dvl", uses_dvl)->capture_default_str();
  app.add_option("--honest-imu", is_honest, "take the IMU's noise for what it is")->capture_default_str();
  app.add_option("--modes", modes)->capture_default_str()->check(CLI::IsMember({"off", "on", "map"}));
  app.add_option("--each", each_s, "list every dive every so many seconds");
  CLI11_PARSE(app, argc, argv);
  fmt::print("{:4} {:4} {:>8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>9} {:>8}\n", "seed", "mode", "third 1",
             "third 2", "third 3", "drift 2", "drift 3", "claimed", "position", "time s");
  for (int i = 0; i < seeds; ++i) {
    ScenarioChanges changes;
    changes.seed = first_seed + static_cast<uint64_t>(i);
    changes.laps = laps;
    VehicleDive vehicle = makeVehicleDive(makeScenario("wreck", changes));
    vehicle.landmarks = landmarksAlong(vehicle.dive.motion, *changes.seed);
    PointSimulationOptions points = vehicle.options;
    points.frame_rate_hz = rate_hz;
    points.tracks = tracks;
    points.end_s = end_s;
    for (const std::string& mode : modes) {
      EstimatorOptions options;
      options.magnetometer.use = mode == "off" ? MagnetometerUse::Off : MagnetometerUse::Absolute;
      options.magnetometer.map = mode == "map";
      options.dvl.use = uses_dvl;
      if (is_honest) {
        options.preintegration.noise_inflation = 1.0;
        options.preintegration.motion_noise = MotionNoiseOptions::none();
        options.imu_axes.gyroscope_sigma = options.imu_axes.accelerometer_sigma = 0.0;
      }
      const WreckRun run = runWreck(vehicle, points, options, each_s);
      fmt::print("{:4} {:4} {:8.3f} {:8.3f} {:8.3f} {:8.3f} {:8.3f} {:8.3f} {:8.2f}m {:8.1f} ", *changes.seed,
                 mode, run.rms_deg(0), run.rms_deg(1), run.rms_deg(2), run.drift_deg(1), run.drift_deg(2),
                 kDegrees * run.sigma_rad, run.position_m, run.estimator_s);
      for (size_t s = 0; s < run.by_status.size(); ++s) {
        if (run.by_status[s] > 0)
          fmt::print(" {} {}", toString(static_cast<MagnetometerStatus>(s)), run.by_status[s]);
      }
      fmt::print("\n");
      for (const Finding& finding : run.findings.ranked())
        if (each_s > 0.0) fmt::print("    {} x {}: {}\n", finding.count, finding.kind, finding.first_message);
      std::fflush(stdout);
    }
  }
  return 0;
}
