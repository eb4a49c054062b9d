// Measures what the magnetometer does to heading and position among magnetic disturbances and near steel:
// each dive of points runs with and without it. Prints the tables of docs/lab-notes/magnetic_harm.md.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <vector>

#include "lodeline/estimator/trials/disturbed_dive.h"
#include "lodeline/util/angles.h"

namespace {

using namespace lodeline;

void printRow(const DisturbedDive& dive, const DiveErrorsOfRun& off, const DiveErrorsOfRun& on) {
  const auto degrees = [](double rad) { return rad * kDegreesPerRadian; };
  fmt::print(
      "{:33} {:>5.0f} {:>6.3f} {:>6.3f} {:>5.2f} {:>7.2f} {:>6.3f} {:>6.3f} {:>5.2f} {:>7.2f} {:>7.2f} "
      "{:>7.2f} {:>6.1f} {:>6.1f} {:>5.0f} {:>5.0f}\n",
      dive.name, on.path_m, degrees(off.heading_rms_rad), degrees(on.heading_rms_rad),
      on.heading_rms_rad / off.heading_rms_rad, on.settled_rms_rad / off.settled_rms_rad, off.position_rms_m,
      on.position_rms_m, on.position_rms_m / off.position_rms_m, degrees(on.north_rms_rad),
      degrees(on.north_end_rad), degrees(on.claimed_rad), 100.0 * on.within_3_sigmas, on.most_sigmas,
      100.0 * on.used_share, 100.0 * on.readmitted_share);
  std::fflush(stdout);
}

void printEach(const DisturbedRun& run, double step_s) {
  double next_s = 0.0;
  for (const HeadingSample& s : run.samples) {
    if (s.time_s < next_s) continue;
    next_s = s.time_s + step_s;
    fmt::print("  {:7.1f} s {:8.3f} deg (claimed {:.3f}) {}\n", s.time_s, s.error_rad * kDegreesPerRadian,
               s.sigma_rad * kDegreesPerRadian, toString(s.status));
  }
  for (const Finding& finding : run.findings.ranked())
    fmt::print("  {}: {}\n", finding.kind, finding.first_message);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Harm of the magnetometer on dives of points: path, m; heading about its mean and position after "
      "alignment (deg, m), without and with magnetometer, and their ratio; that of the headings after the "
      "first 20 s; with it, the error of north (root "
      "mean square, and at the end), what it claims, the share of frames within three claimed sigmas, the "
      "largest error in sigmas, and the share of frames that used the field or used it after a readmission.");
  bool undisturbed = false, on_alone = false;
  std::vector<size_t> numbers;
  double each_s = 0.0;
  uint64_t seed_shift = 0;
  app.add_flag("--undisturbed", undisturbed, "the same caves without disturbance");
  app.add_flag("--on-alone", on_alone, "no runs without magnetometer; their columns are then zero");
  app.add_option("--dives", numbers, "numbers of dives, from 1; all by default");
  app.add_option("--seed-shift", seed_shift, "added to the seed of every dive")->capture_default_str();
  app.add_option("--each", each_s, "list every run with the magnetometer every so many seconds");
  CLI11_PARSE(app, argc, argv);
  const std::vector<DisturbedDive> dives = undisturbed ? undisturbedDives() : disturbedDives();
  if (numbers.empty()) {
    for (size_t i = 1; i <= dives.size(); ++i) numbers.push_back(i);
  }
  fmt::print(
      "{:33} {:>5} {:>6} {:>6} {:>5} {:>7} {:>6} {:>6} {:>5} {:>7} {:>7} {:>7} {:>6} {:>6} {:>5} {:>5}\n",
      "dive", "path", "h off", "h on", "ratio", "settled", "p off", "p on", "ratio", "north", "end",
      "claimed", "in 3s", "most s", "used%", "readm");
  for (const size_t number : numbers) {
    DisturbedDive dive = dives.at(number - 1);
    dive.seed += seed_shift;
    const DisturbedRun off = on_alone ? DisturbedRun() : runDisturbedDive(dive, MagnetometerUse::Off);
    const DisturbedRun on = runDisturbedDive(dive, MagnetometerUse::Absolute);
    printRow(dive, off.errors, on.errors);
    if (each_s > 0.0) printEach(on, each_s);
  }
  return 0;
}
