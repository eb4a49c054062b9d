#include "lodeline/estimator/trials/dive_consistency.h"

#include <atomic>
#include <thread>

namespace lodeline {
namespace {

/// Samples of one dive, one per time, as far as it has estimates.
std::vector<NeesSample> samplesOf(const HeadingTrialOptions& dive, const std::vector<double>& times_s) {
  std::vector<NeesSample> samples;
  TruthComparison truth;
  runTrialDive(dive,
               [&](const SimulatedFrame& frame, const FrameEstimate& estimate, const Estimator& estimator) {
                 const Comparison comparison = truth.compare(frame, estimate, estimator);
                 if (samples.size() == times_s.size() || comparison.time_s < times_s[samples.size()] - 1e-6)
                   return;
                 if (comparison.initialized()) samples.push_back(neesOf(comparison));
               });
  return samples;
}

}  // namespace

HeadingTrialOptions exactDive(double duration_s) {
  HeadingTrialOptions dive;
  dive.duration_s = duration_s;
  dive.frame_rate_hz = 4.0;
  dive.tracks = 40;
  dive.bias_instability = false;
  dive.estimator.camera_calibration.enabled = false;
  return dive;
}

Consistency measureDiveConsistency(const DiveConsistencyOptions& options) {
  std::vector<std::vector<NeesSample>> by_seed(static_cast<size_t>(options.seeds));
  std::atomic<size_t> next = 0;
  const auto work = [&] {
    for (size_t i = next++; i < by_seed.size(); i = next++) {
      HeadingTrialOptions dive = options.dive;
      dive.seed = options.first_seed + i;
      by_seed[i] = samplesOf(dive, options.times_s);
    }
  };
  std::vector<std::jthread> threads;
  for (int i = 1; i < options.threads; ++i) threads.emplace_back(work);
  work();
  threads.clear();

  Consistency result;
  for (size_t row = 0; row < options.times_s.size(); ++row) {
    result.rows.push_back({options.times_s[row], {}});
    for (const std::vector<NeesSample>& samples : by_seed) {
      if (row < samples.size()) result.rows.back().samples.push_back(samples[row]);
    }
  }
  for (const std::vector<NeesSample>& samples : by_seed)
    result.lost += samples.size() < options.times_s.size();
  return result;
}

}  // namespace lodeline
