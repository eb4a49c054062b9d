// Monte Carlo of simulated scenes: is the estimator as good as it says? Prints the table of
// docs/estimator.md.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <numbers>

#include "lodeline/estimator/consistency.h"

namespace {

using namespace lodeline;

struct Column {
  const char* name;
  int coordinates;
  double NeesSample::*figure;
};
constexpr Column kColumns[] = {{"pose", 6, &NeesSample::pose},
                               {"position", 3, &NeesSample::position},
                               {"orientation", 3, &NeesSample::orientation},
                               {"yaw", 1, &NeesSample::yaw},
                               {"motion", 9, &NeesSample::motion}};

void printEach(const Consistency& consistency) {
  for (const ConsistencyRow& row : consistency.rows) {
    for (const NeesSample& sample : row.samples) {
      fmt::print("{:7.1f} s:", row.time_s);
      for (const Column& column : kColumns) fmt::print(" {} {:.2f}", column.name, sample.*column.figure);
      fmt::print(", position {:.3f} ({:.3f}) m\n", sample.position_error_m, sample.position_sigma_m);
    }
  }
}

void print(const Consistency& consistency) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  fmt::print("{:>7} {:>6}", "time s", "seeds");
  for (const Column& column : kColumns)
    fmt::print(" {:>16}", fmt::format("{}/{}", column.name, column.coordinates));
  fmt::print("   position RMS (sigma) cm   yaw RMS (sigma) deg\n");
  for (const ConsistencyRow& row : consistency.rows) {
    const int count = static_cast<int>(row.samples.size());
    if (count == 0) continue;
    fmt::print("{:7.1f} {:6}", row.time_s, count);
    for (const Column& column : kColumns) {
      const NeesBounds bounds = neesBounds(column.coordinates, count);
      const double mean = row.mean(column.figure);
      const char* verdict = mean > bounds.high ? "high" : mean < bounds.low ? "low" : "ok";
      fmt::print(" {:>16}", fmt::format("{:.2f} {}", mean, verdict));
    }
    fmt::print("   {:8.2f} ({:.2f})   {:13.3f} ({:.3f})\n",
               100.0 * row.rootMeanSquare(&NeesSample::position_error_m),
               100.0 * row.rootMeanSquare(&NeesSample::position_sigma_m),
               kDegrees * row.rootMeanSquare(&NeesSample::yaw_error_rad),
               kDegrees * row.rootMeanSquare(&NeesSample::yaw_sigma_rad));
  }
  if (consistency.lost > 0) fmt::print("{} seeds without an estimate in time\n", consistency.lost);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Mean normalised estimation error squared over simulated scenes; an honest estimator shows the "
      "number after the slash. ok/high/low: against bounds that hold with probability 0.999.");
  ConsistencyOptions options;
  double seconds = 60.0;
  bool each = false;
  options.estimator = honestOptions(options.scene);
  app.add_option("--seeds", options.seeds)->capture_default_str();
  app.add_option("--seconds", seconds)->capture_default_str();
  app.add_option("--cameras", options.scene.cameras)->capture_default_str()->check(CLI::Range(1, 2));
  app.add_option("--tracks", options.scene.points.tracks)->capture_default_str();
  app.add_option("--pixel-sigma", options.scene.points.pixel_sigma_px)->capture_default_str();
  app.add_option("--robust-scale", options.estimator.solver.robust_scale_sigmas)->capture_default_str();
  app.add_option("--iterations", options.estimator.solver.max_iterations)->capture_default_str();
  app.add_option("--recent-frames", options.estimator.window.recent_frames)->capture_default_str();
  app.add_option("--keyframes", options.estimator.window.keyframes)->capture_default_str();
  app.add_flag("--each", each, "list every seed too");
  CLI11_PARSE(app, argc, argv);
  std::erase_if(options.times_s, [&](double t) { return t > seconds; });
  if (options.times_s.empty() || options.times_s.back() < seconds) options.times_s.push_back(seconds);
  const Consistency consistency = measureConsistency(options);
  if (each) printEach(consistency);
  print(consistency);
  return 0;
}
