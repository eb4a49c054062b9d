// Monte Carlo test of the estimator's consistency on simulated scenes and dives. Prints the tables of
// docs/lab-notes/consistency.md.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <span>

#include "lodeline/estimator/trials/dive_consistency.h"
#include "lodeline/util/angles.h"

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
constexpr Column kDiveColumns[] = {{"position", 3, &NeesSample::position},
                                   {"orientation", 3, &NeesSample::orientation},
                                   {"yaw", 1, &NeesSample::yaw},
                                   {"velocity", 3, &NeesSample::velocity},
                                   {"b_g", 3, &NeesSample::gyroscope_bias},
                                   {"b_a", 3, &NeesSample::accelerometer_bias}};
const std::map<std::string, MagnetometerUse> kUses = {{"off", MagnetometerUse::Off},
                                                      {"absolute", MagnetometerUse::Absolute}};

void printEach(const Consistency& consistency) {
  for (const ConsistencyRow& row : consistency.rows) {
    for (const NeesSample& sample : row.samples) {
      fmt::print("{:7.1f} s:", row.time_s);
      for (const Column& column : kColumns) fmt::print(" {} {:.2f}", column.name, sample.*column.figure);
      fmt::print(", position {:.3f} ({:.3f}) m\n", sample.position_error_m, sample.position_sigma_m);
    }
  }
}

void printHeader(std::span<const Column> columns) {
  fmt::print("{:>7} {:>6}", "time s", "seeds");
  for (const Column& column : columns)
    fmt::print(" {:>16}", fmt::format("{}/{}", column.name, column.coordinates));
  fmt::print("   position RMS (sigma) cm   yaw RMS (sigma) deg\n");
}

std::string verdict(double mean, const NeesBounds& bounds) {
  return fmt::format("{:.2f} {}", mean, mean > bounds.high ? "high" : mean < bounds.low ? "low" : "ok");
}

void printRow(const ConsistencyRow& row, std::span<const Column> columns, double quantile) {
  const int count = static_cast<int>(row.samples.size());
  if (count == 0) return;
  fmt::print("{:7.1f} {:6}", row.time_s, count);
  for (const Column& column : columns)
    fmt::print(" {:>16}", verdict(row.mean(column.figure), neesBounds(column.coordinates, count, quantile)));
  fmt::print("   {:8.2f} ({:.2f})   {:13.3f} ({:.3f})\n",
             100.0 * row.rootMeanSquare(&NeesSample::position_error_m),
             100.0 * row.rootMeanSquare(&NeesSample::position_sigma_m),
             kDegreesPerRadian * row.rootMeanSquare(&NeesSample::yaw_error_rad),
             kDegreesPerRadian * row.rootMeanSquare(&NeesSample::yaw_sigma_rad));
}

void printBand(std::span<const Column> columns, int seeds) {
  fmt::print("{:>7} {:>6}", "95 %", "");
  for (const Column& column : columns) {
    const NeesBounds band = neesBounds(column.coordinates, seeds, kBand95);
    fmt::print(" {:>16}", fmt::format("{:.2f}..{:.2f}", band.low, band.high));
  }
  fmt::print("\n");
}

void print(const Consistency& consistency, std::span<const Column> columns, double quantile) {
  printHeader(columns);
  for (const ConsistencyRow& row : consistency.rows) printRow(row, columns, quantile);
  if (consistency.lost > 0) fmt::print("{} seeds without an estimate in time\n", consistency.lost);
}

/// Runs in batches, each of which adds to the table, so that a long study shows early results.
void studyDives(double minutes, int samples, DiveConsistencyOptions options) {
  constexpr int kBatch = 10;
  options.dive.duration_s = 60.0 * minutes;
  for (int i = 1; i <= samples; ++i) options.times_s.push_back(60.0 * minutes * i / samples - 1.0);
  const int seeds = options.seeds;
  Consistency all;
  for (int done = 0; done < seeds; done += options.seeds) {
    options.seeds = std::min(kBatch, seeds - done);
    const Consistency batch = measureDiveConsistency(options);
    options.first_seed += static_cast<uint64_t>(options.seeds);
    all.rows.resize(batch.rows.size());
    for (size_t row = 0; row < batch.rows.size(); ++row) {
      all.rows[row].time_s = batch.rows[row].time_s;
      const std::vector<NeesSample>& samples_now = batch.rows[row].samples;
      all.rows[row].samples.insert(all.rows[row].samples.end(), samples_now.begin(), samples_now.end());
    }
    all.lost += batch.lost;
    print(all, kDiveColumns, kBand95);
    printBand(kDiveColumns, done + options.seeds);
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Mean normalized estimation error squared over simulated scenes; an honest estimator shows the "
      "number after the slash. ok/high/low: against bounds that hold with probability 0.999. With --minutes, "
      "over dives of so many minutes, against the band of probability 0.95.");
  ConsistencyOptions options;
  DiveConsistencyOptions dives;
  dives.dive = exactDive(0.0);
  dives.dive.trouble = FieldTrouble::HardIron;
  double seconds = 60.0, minutes = 0.0;
  int samples = 10;
  bool each = false, as_shipped = false, as_believed = false;
  std::string magnetometer = "off";
  options.estimator = honestOptions(options.scene);
  // The cameras equal their calibration files. A camera error model would increase the stated sigma for
  // errors that do not occur here.
  options.estimator.camera_calibration.enabled = false;
  SolverOptions solver;
  WindowOptions window;
  app.add_option("--seeds", options.seeds)->capture_default_str();
  app.add_option("--seconds", seconds)->capture_default_str();
  app.add_option("--cameras", options.scene.cameras)->capture_default_str()->check(CLI::Range(1, 2));
  app.add_option("--tracks", options.scene.points.tracks, "default of dives: 40")->capture_default_str();
  app.add_option("--pixel-sigma", options.scene.points.pixel_sigma_px)->capture_default_str();
  app.add_option("--robust-scale", solver.robust_scale_sigmas)->capture_default_str();
  app.add_option("--iterations", solver.max_iterations)->capture_default_str();
  app.add_option("--recent-frames", window.recent_frames)->capture_default_str();
  app.add_option("--keyframes", window.keyframes)->capture_default_str();
  app.add_option("--startup-frames", window.startup_frames)->capture_default_str();
  app.add_flag("--each", each, "list every seed too");
  app.add_option("--minutes", minutes, "dives of so many minutes in place of scenes");
  app.add_option("--first-seed", dives.first_seed, "of dives")->capture_default_str();
  app.add_option("--rate", dives.dive.frame_rate_hz, "of dives, frames a second")->capture_default_str();
  app.add_option("--samples", samples, "of each dive")->capture_default_str();
  app.add_option("--threads", dives.threads, "for dives")->capture_default_str();
  app.add_option("--magnetometer", magnetometer, "of dives")
      ->check(CLI::IsMember(kUses))
      ->capture_default_str();
  app.add_flag(
      "--as-believed", as_believed,
      "the magnetometer of a dive has the errors that the estimator believes in, drawn anew for each: "
      "hard iron, its walk, a wandering field; else 0.3 uT of hard iron");
  app.add_flag("--as-shipped", as_shipped,
               "dives with flicker noise, and the estimator's default noise, priors and camera calibration");
  CLI11_PARSE(app, argc, argv);
  options.estimator.solver = solver;
  options.estimator.window = window;
  if (minutes > 0.0) {
    if (as_believed) dives.dive.trouble = FieldTrouble::AsBelieved;
    if (as_shipped) {
      dives.dive.honest_imu = false;
      dives.dive.bias_instability = true;
      dives.dive.estimator.camera_calibration.enabled = true;
    }
    dives.seeds = options.seeds;
    dives.dive.cameras = options.scene.cameras;
    if (app.count("--tracks") > 0) dives.dive.tracks = options.scene.points.tracks;
    dives.dive.estimator.solver = solver;
    dives.dive.estimator.window = window;
    dives.dive.estimator.magnetometer.use = kUses.at(magnetometer);
    studyDives(minutes, samples, dives);
    return 0;
  }
  std::erase_if(options.times_s, [&](double t) { return t > seconds; });
  if (options.times_s.empty() || options.times_s.back() < seconds) options.times_s.push_back(seconds);
  const Consistency consistency = measureConsistency(options);
  if (each) printEach(consistency);
  print(consistency, kColumns, kBand999);
  return 0;
}
