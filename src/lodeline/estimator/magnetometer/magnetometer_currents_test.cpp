#include <fmt/core.h>
#include <gtest/gtest.h>

#include "lodeline/estimator/trials/heading_trial.h"
#include "lodeline/util/angles.h"

// Electric currents beside a magnetometer, in dives with simulated points.

namespace lodeline {
namespace {

HeadingTrialOptions trialOptions(double duration_s) {
  HeadingTrialOptions options;
  options.duration_s = duration_s;
  options.frame_rate_hz = 4.0;
  options.tracks = 30;
  options.estimator.magnetometer.use = MagnetometerUse::Absolute;
  options.currents.emplace();
  return options;
}

void show(const char* what, const HeadingTrial& trial) {
  fmt::print("{}: rms {:.2f} aligned {:.3f} largest {:.2f} claimed {:.2f} deg used {:.2f}, {:.1f} s;", what,
             trial.rms(20.0) / kDegree, trial.alignedRms(20.0) / kDegree, trial.largest(20.0) / kDegree,
             trial.claimed(20.0) / kDegree, trial.share(MagnetometerStatus::Used), trial.estimator_s);
  for (const auto& [status, frames] : trial.current_status) fmt::print(" {} {}", status, frames);
  for (const Finding& finding : trial.findings.ranked()) fmt::print(" [{}]", finding.kind);
  fmt::print("\n");
}

TEST(CurrentTrial, Shows) {
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    HeadingTrialOptions options = trialOptions(120.0);
    options.seed = seed;
    options.currents->has_sensor = false;
    show("no sensor", runHeadingTrial(options));
    options.estimator.magnetometer.use = MagnetometerUse::Off;
    show("off", runHeadingTrial(options));
    options.estimator.magnetometer.use = MagnetometerUse::Absolute;
    options.currents->has_sensor = true;
    show("calibrated", runHeadingTrial(options));
    options.currents->is_calibrated = false;
    show("learned", runHeadingTrial(options));
    options.currents->is_calibrated = true;
    options.currents->moved_rad = 0.6;
    show("moved", runHeadingTrial(options));
  }
}

}  // namespace
}  // namespace lodeline
