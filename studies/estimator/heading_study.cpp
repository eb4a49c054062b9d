// Measures the heading error over simulated dives of points, with and without magnetometer. Prints the table
// of docs/lab-notes/magnetometer.md.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <map>
#include <numbers>

#include "lodeline/estimator/trials/heading_trial.h"

namespace {

using namespace lodeline;

const std::map<std::string, MagnetometerUse> kUses = {{"off", MagnetometerUse::Off},
                                                      {"absolute", MagnetometerUse::Absolute},
                                                      {"paper", MagnetometerUse::Paper}};

/// One line of the table: root mean squares over the seeds, and their maximum.
class Row {
 public:
  void add(const HeadingTrial& trial) {
    ++count_;
    rms_ += std::pow(trial.rms(), 2);
    reported_ += std::pow(trial.claimed(), 2);
    aligned_ += std::pow(trial.alignedRms(), 2);
    largest_ = std::max(largest_, trial.largest());
    used_ += trial.share(MagnetometerStatus::Used);
    readmitted_ += trial.share(MagnetometerStatus::Readmitted);
    inconsistent_ += trial.share(MagnetometerStatus::Inconsistent);
    correlated_noise_sigma_T_ += trial.correlated_noise_sigma_T;
    ms_ += 1e3 * trial.estimator_s / static_cast<double>(trial.samples.size());
    reference_ = trial.reference;
  }
  void print(const std::string& trouble, const std::string& use) const {
    const auto degrees = [&](double squares) {
      return std::sqrt(squares / count_) * 180.0 / std::numbers::pi;
    };
    fmt::print(
        "{:13} {:9} {:>8.3f} {:>9.3f} {:>9.3f} {:>9.3f} {:>7.1f} {:>7.1f} {:>7.1f} {:>8.3f} {:>7.2f}  {}\n",
        trouble, use, degrees(rms_), degrees(reported_), largest_ * 180.0 / std::numbers::pi,
        degrees(aligned_), 100.0 * used_ / count_, 100.0 * readmitted_ / count_,
        100.0 * inconsistent_ / count_, 1e6 * correlated_noise_sigma_T_ / count_, ms_ / count_,
        toString(reference_));
    std::fflush(stdout);
  }

 private:
  int count_ = 0;
  double rms_ = 0.0, reported_ = 0.0, aligned_ = 0.0, largest_ = 0.0, used_ = 0.0, readmitted_ = 0.0,
         inconsistent_ = 0.0, correlated_noise_sigma_T_ = 0.0, ms_ = 0.0;
  HeadingReference reference_ = HeadingReference::Start;
};

void printEach(const HeadingTrial& trial, double step_s) {
  double next_s = 0.0;
  for (const HeadingSample& s : trial.samples) {
    if (s.time_s < next_s) continue;
    next_s = s.time_s + step_s;
    fmt::print("  {:7.1f} s {:8.3f} deg (claimed {:.3f}) {}\n", s.time_s,
               s.error_rad * 180.0 / std::numbers::pi, s.sigma_rad * 180.0 / std::numbers::pi,
               toString(s.status));
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Heading errors of simulated dives in degrees, from 60 s on: root mean square over time and seeds "
      "against north (or against the first heading), claimed, largest, root mean square with the mean "
      "taken off; share of frames whose field was used, readmitted or inconsistent; its lasting error as "
      "learned, "
      "uT; time of the estimator a frame.");
  HeadingTrialOptions options;
  int seeds = 3;
  double minutes = 30.0, each_s = 0.0;
  std::vector<int> troubles = {0, 1, 2, 3, 4, 5, 6};
  std::vector<std::string> uses = {"off", "absolute", "paper"};
  MagnetometerOptions& magnetometer = options.estimator.magnetometer;
  uint64_t first_seed = 1;
  app.add_option("--seeds", seeds)->capture_default_str();
  app.add_option("--first-seed", first_seed)->capture_default_str();
  app.add_option("--minutes", minutes)->capture_default_str();
  app.add_option("--tracks", options.tracks)->capture_default_str();
  app.add_option("--rate", options.frame_rate_hz, "frames a second")->capture_default_str();
  app.add_option("--cameras", options.cameras)->capture_default_str()->check(CLI::Range(1, 2));
  app.add_option("--troubles", troubles,
                 "0 none, 1 hard iron, 2 disturbances, 3 tank, 4 dipole, 5 calibration, 6 lamp, 7 soft iron, "
                 "8 misaligned, 9 scale, 10 swapped axes, 11 boat, 12 as believed, 13 beside, 14 at start, "
                 "15 magnetite, 16 together")
      ->capture_default_str();
  app.add_option("--uses", uses)->capture_default_str()->check(CLI::IsMember(kUses));
  app.add_option("--grade", options.imu_grade, "of the IMU")
      ->capture_default_str()
      ->check(CLI::IsMember({"gx5-25", "gv7", "consumer"}));
  app.add_option("--honest-imu", options.honest_imu, "take the IMU's noise for what it is")
      ->capture_default_str();
  app.add_option("--steps", magnetometer.step.enabled, "correct the field by its steps")
      ->capture_default_str();
  app.add_option("--steps-from", magnetometer.step.settling_s, "s, when steps begin to be looked for")
      ->capture_default_str();
  app.add_option("--lamp-from", options.lamp_earliest_s, "s, the earliest that it is switched")
      ->capture_default_str();
  app.add_option("--lamp-switchings", options.lamp_switchings, "of one lamp, at even intervals; 0: drawn")
      ->capture_default_str();
  app.add_option("--map", magnetometer.map, "map the field near steel")->capture_default_str();
  app.add_option("--floor", magnetometer.correlated_noise_sigma_T, "T")->capture_default_str();
  app.add_option("--floor-correlation", magnetometer.correlated_noise_time_s, "s")->capture_default_str();
  app.add_option("--student-dof", magnetometer.student_dof, "degrees of it, of the floor's distribution")
      ->capture_default_str();
  app.add_option("--gate-sigmas", magnetometer.gate.max_sigmas,
                 "limit of size, dip and heading; 1e9: no gate")
      ->capture_default_str();
  app.add_option("--offset-sigma", magnetometer.offset_sigma_T, "T")->capture_default_str();
  app.add_option("--offset-walk", magnetometer.offset_walk_T_per_sqrt_s, "T/sqrt(s)")->capture_default_str();
  app.add_option("--each", each_s, "list every dive every so many seconds");
  CLI11_PARSE(app, argc, argv);
  options.duration_s = 60.0 * minutes;
  fmt::print("{:13} {:9} {:>8} {:>9} {:>9} {:>9} {:>7} {:>7} {:>7} {:>8} {:>7}\n", "trouble", "use", "rms",
             "claimed", "largest", "aligned", "used %", "readm %", "incon %", "floor uT", "ms");
  for (const int trouble : troubles) {
    options.trouble = static_cast<FieldTrouble>(trouble);
    for (const std::string& use : uses) {
      magnetometer.use = kUses.at(use);
      Row row;
      for (int seed = 0; seed < seeds; ++seed) {
        options.seed = first_seed + static_cast<uint64_t>(seed);
        const HeadingTrial trial = runHeadingTrial(options);
        if (each_s > 0.0) printEach(trial, each_s);
        row.add(trial);
      }
      row.print(toString(options.trouble), use);
    }
  }
  return 0;
}
