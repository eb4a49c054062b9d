#pragma once

#include "lodeline/estimator/trials/consistency.h"
#include "lodeline/estimator/trials/heading_trial.h"

namespace lodeline {

/// Options of a Monte Carlo of whole dives instead of scenes.
struct DiveConsistencyOptions {
  HeadingTrialOptions dive;  ///< its seed is filled in
  int seeds = 50;
  uint64_t first_seed = 1;
  std::vector<double> times_s;  ///< of the samples, from the start of the motion, ascending
  int threads = 1;
};

/// Options of dives that match the estimator's model exactly: IMU noise as stated and without flicker,
/// calibration held, one frame per quarter second with 40 tracks, so that hours can be simulated.
HeadingTrialOptions exactDive(double duration_s);

/// Runs the dive once per seed; the samples do not depend on the number of threads.
Consistency measureDiveConsistency(const DiveConsistencyOptions& options);

}  // namespace lodeline
