// Compares the accuracy of a batch solution with the sliding window on simulated dives of points. Prints the
// table of docs/lab-notes/refinement.md.

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <Eigen/Geometry>
#include <cmath>

#include "lodeline/batch/refine.h"
#include "lodeline/estimator/trials/dive_consistency.h"
#include "lodeline/util/angles.h"

namespace {

using namespace lodeline;

/// Root mean square errors of one trajectory.
struct Errors {
  double aligned_m = 0.0;   ///< positions, after SE(3) alignment
  double anchored_m = 0.0;  ///< without alignment, from the true first position and heading
  double yaw_rad = 0.0;
  double end_m = 0.0;  ///< of the last position without alignment, where the window has also used all data
};

Errors errorsOf(const std::vector<FrameEstimate>& frames, const std::vector<Rigid3>& truth) {
  const auto count = static_cast<Eigen::Index>(frames.size());
  Eigen::Matrix3Xd estimated(3, count), expected(3, count);
  Errors errors;
  for (Eigen::Index i = 0; i < count; ++i) {
    const Rigid3& pose = frames[static_cast<size_t>(i)].state.world_from_body;
    const Eigen::Matrix<double, 6, 1> error = perturbationBetween(truth[static_cast<size_t>(i)], pose);
    errors.anchored_m += error.head<3>().squaredNorm();
    errors.yaw_rad += error[5] * error[5];
    errors.end_m = error.head<3>().norm();
    estimated.col(i) = pose.translation;
    expected.col(i) = truth[static_cast<size_t>(i)].translation;
  }
  const Eigen::Matrix4d aligned = Eigen::umeyama(estimated, expected, false);
  const Eigen::Matrix3Xd left =
      (aligned.topLeftCorner<3, 3>() * estimated).colwise() + aligned.topRightCorner<3, 1>().eval();
  const auto n = static_cast<double>(count);
  errors.aligned_m = std::sqrt((left - expected).squaredNorm() / n);
  errors.anchored_m = std::sqrt(errors.anchored_m / n);
  errors.yaw_rad = std::sqrt(errors.yaw_rad / n);
  return errors;
}

struct Trial {
  Errors window, batch;
  double batch_nees = 0.0;  ///< of the pose (6) at the end
  RefinementSummary summary;
};

Trial runTrial(const HeadingTrialOptions& options, const RefinementOptions& wanted) {
  EstimatorLog record(wanted.state_interval_s);
  std::vector<Rigid3> truth;
  TruthComparison comparison;
  Rig rig;
  EstimatorOptions estimator_options;
  Trial trial;
  Refinement refinement;
  runTrialDive(options,
               [&](const SimulatedFrame& frame, const FrameEstimate& estimate, const Estimator& estimator) {
                 record.add(frame.tracks, frame.imu, estimate, estimator);
                 const Comparison compared = comparison.compare(frame, estimate, estimator);
                 if (compared.initialized()) truth.push_back(compared.true_world_from_body);
                 rig = estimator.rig();
                 estimator_options = estimator.options();
                 record.finish(estimator);
               });
  refinement = refine(rig, estimator_options, record, wanted);
  trial.summary = refinement.summary;
  trial.window = errorsOf(record.frames(), truth);
  trial.batch = errorsOf(refinement.frames, truth);
  const FrameEstimate& last = refinement.frames.back();
  const Eigen::Matrix<double, 6, 1> error = perturbationBetween(truth.back(), last.state.world_from_body);
  trial.batch_nees = error.dot(last.covariance.topLeftCorner<6, 6>().ldlt().solve(error));
  return trial;
}

double ratio(double window, double batch) { return batch > 0.0 ? window / batch : 0.0; }

void print(uint64_t seed, const Trial& trial) {
  fmt::print(
      "{:>5} {:>8.2f} {:>8.2f} {:>6.2f} {:>9.2f} {:>8.2f} {:>6.2f} {:>7.2f} {:>8.2f} {:>8.3f} {:>8.3f} "
      "{:>7.1f} {:>7} {:>5} "
      "{:>7.1f} {}\n",
      seed, 100.0 * trial.window.aligned_m, 100.0 * trial.batch.aligned_m,
      ratio(trial.window.aligned_m, trial.batch.aligned_m), 100.0 * trial.window.anchored_m,
      100.0 * trial.batch.anchored_m, ratio(trial.window.anchored_m, trial.batch.anchored_m),
      100.0 * trial.window.end_m, 100.0 * trial.batch.end_m, kDegreesPerRadian * trial.window.yaw_rad,
      kDegreesPerRadian * trial.batch.yaw_rad, trial.batch_nees, trial.summary.states,
      trial.summary.iterations, trial.summary.processor_s,
      trial.summary.usable() ? "" : trial.summary.refusal);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Position errors (RMSE, cm) of the sliding window and of the batch solution of the same dive");
  HeadingTrialOptions dive = exactDive(0.0);
  RefinementOptions wanted;
  wanted.state_interval_s = 0.0;
  int seeds = 5;
  uint64_t first_seed = 1;
  double minutes = 10.0;
  bool absolute = false;
  app.add_option("--seeds", seeds)->capture_default_str();
  app.add_option("--first-seed", first_seed)->capture_default_str();
  app.add_option("--minutes", minutes)->capture_default_str();
  app.add_option("--cameras", dive.cameras)->capture_default_str()->check(CLI::Range(1, 2));
  app.add_option("--tracks", dive.tracks)->capture_default_str();
  app.add_option("--rate", dive.frame_rate_hz, "frames a second")->capture_default_str();
  app.add_option("--interval", wanted.state_interval_s, "of the states, s; 0: every frame is one")
      ->capture_default_str();
  app.add_option("--recent", dive.estimator.window.recent_frames, "newest frames in the window")
      ->capture_default_str();
  app.add_option("--keyframes", dive.estimator.window.keyframes, "older keyframes in the window")
      ->capture_default_str();
  app.add_option("--parallax", dive.estimator.keyframe.min_parallax_rad, "of a new keyframe, rad")
      ->capture_default_str();
  app.add_option("--gap", dive.estimator.window.interpolated_gap_s,
                 "between keyframes beside which other frames' observations are kept, s")
      ->capture_default_str();
  app.add_option("--spacing", dive.estimator.window.interpolated_spacing_s, "of such frames, s")
      ->capture_default_str();
  app.add_flag("--absolute", absolute, "with magnetometer");
  CLI11_PARSE(app, argc, argv);
  dive.duration_s = 60.0 * minutes;
  dive.estimator.magnetometer.use = absolute ? MagnetometerUse::Absolute : MagnetometerUse::Off;
  fmt::print("{:>5} {:>8} {:>8} {:>6} {:>9} {:>8} {:>6} {:>7} {:>8} {:>8} {:>8} {:>7} {:>7} {:>5} {:>7}\n",
             "seed", "window", "batch", "ratio", "anchored", "batch", "ratio", "at end", "batch", "yaw deg",
             "batch", "NEES/6", "states", "steps", "s");
  double window = 0.0, batch = 0.0, anchored_window = 0.0, anchored_batch = 0.0, end_window = 0.0,
         end_batch = 0.0;
  for (int i = 0; i < seeds; ++i) {
    dive.seed = first_seed + static_cast<uint64_t>(i);
    const Trial trial = runTrial(dive, wanted);
    print(dive.seed, trial);
    window += std::pow(trial.window.aligned_m, 2);
    batch += std::pow(trial.batch.aligned_m, 2);
    anchored_window += std::pow(trial.window.anchored_m, 2);
    anchored_batch += std::pow(trial.batch.anchored_m, 2);
    end_window += std::pow(trial.window.end_m, 2);
    end_batch += std::pow(trial.batch.end_m, 2);
  }
  fmt::print("window / batch over all: {:.2f} after alignment, {:.2f} from equal starts, {:.2f} at the end\n",
             std::sqrt(window / batch), std::sqrt(anchored_window / anchored_batch),
             std::sqrt(end_window / end_batch));
  return 0;
}
