// Measures the heading error of a vehicle in laps around and through a steel wreck: simulated points,
// magnetometer off, on, and with the map of the field. Prints the table of docs/lab-notes/magnetic_map.md.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "lodeline/estimator/estimator.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/util/thread_clock.h"
#include "simulation/dive/point_dive.h"

namespace {

using namespace lodeline;

constexpr double kDegrees = 180.0 / std::numbers::pi;

struct WreckRun {
  std::array<double, 3> squares{};  ///< of heading errors against the first heading, in thirds of the dive
  std::array<int, 3> counts{};
  double sigma_rad = 0.0, position_m = 0.0, estimator_s = 0.0;  ///< the first two at the end
  std::array<int, 10> by_status{};
  Diagnostics findings;

  double rms_deg(int third) const {
    return kDegrees * std::sqrt(squares[static_cast<size_t>(third)] / counts[static_cast<size_t>(third)]);
  }
};

WreckRun runWreck(const VehicleDive& vehicle, const PointSimulationOptions& points,
                  const EstimatorOptions& options, double each_s) {
  WreckRun run;
  PointSimulation simulation = vehicle.simulate(points);
  Estimator estimator(vehicle.givenRig(), options, &run.findings);
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
    if (estimate.status == Status::Waiting) { if (getenv("WAITSHOW")) fmt::print("{} tracks {} waits for {}\n", time_s, frame->tracks.observations.size(), estimate.waiting_for); continue; }
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
      "each third of the dive, sigma and position error at the end.");
  int seeds = 1, laps = 3;
  uint64_t first_seed = 1;
  double rate_hz = 4.0, each_s = 0.0, end_s = 1e9;
  int tracks = 60;
  bool uses_dvl = true;
  std::vector<std::string> modes = {"off", "on", "map"};
  app.add_option("--seeds", seeds)->capture_default_str();
  app.add_option("--first-seed", first_seed)->capture_default_str();
  app.add_option("--laps", laps)->capture_default_str();
  app.add_option("--rate", rate_hz, "frames a second")->capture_default_str();
  app.add_option("--tracks", tracks)->capture_default_str();
  app.add_option("--end", end_s, "s, end of the dive");
  app.add_option("--dvl", uses_dvl)->capture_default_str();
  app.add_option("--modes", modes)->capture_default_str()->check(CLI::IsMember({"off", "on", "map"}));
  app.add_option("--each", each_s, "list every dive every so many seconds");
  CLI11_PARSE(app, argc, argv);
  fmt::print("{:4} {:4} {:>8} {:>8} {:>8} {:>8} {:>9} {:>8}\n", "seed", "mode", "third 1", "third 2",
             "third 3", "claimed", "position", "time s");
  for (int i = 0; i < seeds; ++i) {
    ScenarioChanges changes;
    changes.seed = first_seed + static_cast<uint64_t>(i);
    changes.laps = laps;
    const VehicleDive vehicle = makeVehicleDive(makeScenario("wreck", changes));
    PointSimulationOptions points = vehicle.options;
    points.frame_rate_hz = rate_hz;
    points.tracks = tracks;
    points.end_s = end_s;
    for (const std::string& mode : modes) {
      EstimatorOptions options;
      options.magnetometer.use = mode == "off" ? MagnetometerUse::Off : MagnetometerUse::Absolute;
      options.magnetometer.map = mode == "map";
      options.dvl.use = uses_dvl;
      const WreckRun run = runWreck(vehicle, points, options, each_s);
      fmt::print("{:4} {:4} {:8.3f} {:8.3f} {:8.3f} {:8.3f} {:8.2f}m {:8.1f} ", *changes.seed, mode,
                 run.rms_deg(0), run.rms_deg(1), run.rms_deg(2), kDegrees * run.sigma_rad, run.position_m,
                 run.estimator_s);
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
