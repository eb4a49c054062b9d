#include "lodeline/batch/refine.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>

#include "lodeline/batch/batch_problem.h"
#include "lodeline/estimator/trials/dive_consistency.h"
#include "lodeline/estimator/trials/scene.h"
#include "lodeline/problem/state/camera_states.h"

namespace lodeline {
namespace {

/// A scene run through the estimator and recorded for the batch solution.
struct ForwardRun {
  TestScene scene;
  EstimatorOptions options;
  Diagnostics diagnostics;
  Estimator estimator;
  EstimatorLog record;
  std::vector<Comparison> comparisons;  // of the frames that have a pose

  using Tamper = std::function<void(double time_s, SimulatedFrame& frame)>;
  using Change = std::function<void(EstimatorOptions& options)>;

  explicit ForwardRun(const TestSceneOptions& wanted, double state_interval_s = 0.0,
                      const Tamper& tamper = {}, const Change& change = {})
      : scene(wanted),
        options(optionsOf(wanted, change)),
        estimator(scene.rig(), options, &diagnostics),
        record(state_interval_s) {
    TruthComparison truth;
    while (auto frame = scene.next()) {
      if (tamper) tamper(scene.secondsOf(frame->truth.time), *frame);
      const FrameEstimate estimate = estimator.add(frame->tracks, frame->imu);
      record.add(frame->tracks, frame->imu, estimate, estimator);
      const Comparison comparison = truth.compare(*frame, estimate, estimator);
      if (comparison.initialized()) comparisons.push_back(comparison);
    }
    record.finish(estimator);
  }

  static EstimatorOptions optionsOf(const TestSceneOptions& wanted, const Change& change) {
    EstimatorOptions options = honestOptions(wanted);
    options.camera_calibration.enabled = false;
    if (change) change(options);
    return options;
  }

  Refinement refined() const { return refine(scene.rig(), options, record); }

  double rootMeanSquare(const std::vector<FrameEstimate>& frames) const {
    double sum = 0.0;
    for (size_t i = 0; i < frames.size(); ++i)
      sum += (frames[i].state.world_from_body.translation - comparisons[i].true_world_from_body.translation)
                 .squaredNorm();
    return std::sqrt(sum / static_cast<double>(frames.size()));
  }
};

TestSceneOptions smallScene(int cameras) {
  TestSceneOptions options;
  options.cameras = cameras;
  options.duration_s = 12.0;
  options.points.tracks = cameras == 1 ? 80 : 40;
  options.points.frame_rate_hz = 10.0;
  return options;
}

class RefineTest : public testing::TestWithParam<int> {};

TEST_P(RefineTest, LowersTheCostAndTheErrorAndStaysWithinItsSigmas) {
  const ForwardRun run(smallScene(GetParam()));
  const Refinement refinement = run.refined();
  const RefinementSummary& summary = refinement.summary;
  ASSERT_TRUE(summary.usable()) << summary.refusal;
  EXPECT_TRUE(summary.converged);
  EXPECT_LT(summary.first_round_cost, summary.forward_cost);
  // Whitened residuals of noise as stated: two per observation, under a loss that reduces their weight.
  const double worth = static_cast<double>(summary.observations) / summary.observation_variance;
  EXPECT_NEAR(2.0 * summary.cost / (2.0 * worth), 0.7, 0.2);
  ASSERT_EQ(refinement.frames.size(), run.comparisons.size());
  EXPECT_LT(run.rootMeanSquare(refinement.frames), run.rootMeanSquare(run.record.frames()));
  for (size_t i = 0; i < refinement.frames.size(); i += 10) {
    const FrameEstimate& frame = refinement.frames[i];
    const Eigen::Matrix<double, 6, 1> error =
        perturbationBetween(run.comparisons[i].true_world_from_body, frame.state.world_from_body);
    const double nees = error.dot(frame.covariance.topLeftCorner<6, 6>().ldlt().solve(error));
    EXPECT_LT(nees, 30.0) << "at " << run.comparisons[i].time_s
                          << " s";  // exceeded with a probability of 0.00004 by a consistent estimate
  }
}

TEST_P(RefineTest, FramesBetweenStatesAreAsGoodAsStates) {
  const ForwardRun run(smallScene(GetParam()), 0.5);
  const Refinement refinement = run.refined();
  ASSERT_TRUE(refinement.summary.usable());
  EXPECT_LT(refinement.summary.states, static_cast<int>(refinement.frames.size()));
  EXPECT_LT(run.rootMeanSquare(refinement.frames), 1.1 * run.rootMeanSquare(run.record.frames()));
  for (size_t i = 1; i < refinement.frames.size(); ++i) {
    // No jumps from a frame to a following state.
    const NavigationState& before = refinement.frames[i - 1].state;
    const NavigationState& now = refinement.frames[i].state;
    const double dt_s = (now.time - before.time).seconds();
    const Vec3 mean_velocity_W = 0.5 * (before.velocity_W + now.velocity_W);
    EXPECT_LT((now.world_from_body.translation - before.world_from_body.translation - dt_s * mean_velocity_W)
                  .norm(),
              0.01);
  }
}

INSTANTIATE_TEST_SUITE_P(Cameras, RefineTest, testing::Values(1, 2));

/// A dive with simulated points through windows with `keyframes` keyframes, and its refinement.
Refinement refinedDive(int keyframes, double duration_s) {
  HeadingTrialOptions dive = exactDive(duration_s);
  dive.estimator.window.keyframes = keyframes;
  EstimatorLog record(0.0);
  Rig rig;
  EstimatorOptions options;
  runTrialDive(dive,
               [&](const SimulatedFrame& frame, const FrameEstimate& estimate, const Estimator& estimator) {
                 record.add(frame.tracks, frame.imu, estimate, estimator);
                 rig = estimator.rig();
                 options = estimator.options();
                 record.finish(estimator);
               });
  return refine(rig, options, record);
}

// Directions that only the whole dive determines converge in many steps of small gain.
TEST(Refine, EndsAtTheSameSolutionWhereverTheRunWas) {
  const Refinement a = refinedDive(12, 240.0), b = refinedDive(4, 240.0);
  ASSERT_TRUE(a.summary.usable() && b.summary.usable());
  ASSERT_EQ(a.frames.size(), b.frames.size());
  double squares = 0.0;
  for (size_t i = 0; i < a.frames.size(); ++i)
    squares += (a.frames[i].state.world_from_body.translation - b.frames[i].state.world_from_body.translation)
                   .squaredNorm();
  EXPECT_GT(b.summary.moved_rms_m, 0.2 * b.summary.sigma_m) << "the runs must have been elsewhere";
  const double apart_m = std::sqrt(squares / static_cast<double>(a.frames.size()));
  EXPECT_LT(apart_m, 0.02 * a.summary.sigma_m);
}

TEST(Refine, GivesTheSameBytesOnAnyNumberOfCores) {
  const ForwardRun run(smallScene(2), 0.3);
  const Refinement on_all = run.refined();
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Refinement on_one = run.refined();
  ASSERT_EQ(on_one.frames.size(), on_all.frames.size());
  for (size_t i = 0; i < on_all.frames.size(); ++i) {
    EXPECT_EQ(on_one.frames[i].state.world_from_body.translation,
              on_all.frames[i].state.world_from_body.translation);
    EXPECT_EQ(on_one.frames[i].covariance, on_all.frames[i].covariance);
  }
}

TEST(Refine, LeavesOutOutliers) {
  TestSceneOptions options = smallScene(2);
  options.points.outlier_share = 0.05;
  const ForwardRun run(options);
  const Refinement refinement = run.refined();
  ASSERT_TRUE(refinement.summary.usable());
  EXPECT_LT(run.rootMeanSquare(refinement.frames), 0.05);
}

TEST(Refine, CarriesOnThroughDarkness) {
  TestSceneOptions options = smallScene(2);
  options.points.blackouts = {{5.0, 2.0}};
  const ForwardRun run(options);
  const Refinement refinement = run.refined();
  ASSERT_TRUE(refinement.summary.usable());
  EXPECT_LT(run.rootMeanSquare(refinement.frames), run.rootMeanSquare(run.record.frames()));
}

// One camera that has waited for long knows its scale at once. The prior on the first frame must be recorded
// before any of the initial frames is marginalized.
TEST(Refine, StartsFromWhatWasBelievedBeforeAnyFrameWent) {
  const ForwardRun run(smallScene(1), 0.0, {}, [](EstimatorOptions& options) {
    options.window.startup_frames_mono = 2;
    options.window.startup_scale_sigma = 1.0;
  });
  const std::vector<std::string>& names = run.record.startPrior().names;
  EXPECT_EQ(std::count(names.begin(), names.end(), "pose"), 1);
  EXPECT_EQ(std::count(names.begin(), names.end(), "motion"), 1);
  EXPECT_GT(run.record.states().size(), run.record.frames().size()) << "those of the start as well";
  const Refinement refinement = run.refined();
  ASSERT_TRUE(refinement.summary.usable()) << refinement.summary.refusal;
  EXPECT_LT(run.rootMeanSquare(refinement.frames), run.rootMeanSquare(run.record.frames()));
}

// A landmark in the middle of its observations, one of which is an outlier, would lose the others as well.
TEST(Refine, LosesTheStrayingObservationsAlone) {
  TestSceneOptions options = smallScene(2);
  options.points.outlier_share = 0.05;
  const ForwardRun run(options);
  EXPECT_NEAR(run.refined().summary.outlier_share, 0.05, 0.02);
}

TEST(Refine, LeavesLensesAsTheRunFoundThem) {
  const ForwardRun run(smallScene(2), 0.5, {}, [](EstimatorOptions& options) {
    options.camera_calibration.enabled = true;
    options.camera_calibration.trust_confirmed_files = false;  // otherwise these correct files would be held
  });
  BatchProblem problem(run.scene.rig(), run.options, run.record);
  BlockSkylineCholesky hessian = problem.emptyMatrix();
  Eigen::VectorXd gradient;
  problem.linearize(&hessian, &gradient);
  ASSERT_TRUE(hessian.factorize());
  problem.step(hessian.solve(-gradient));
  const std::vector<ParameterBlock*> lenses = cameraStates(problem.window()).intrinsics;
  ASSERT_EQ(lenses.size(), 2u);
  for (const ParameterBlock* lens : lenses) {
    const std::vector<double>& found = run.record.globals().at(lens->name);
    EXPECT_GT(std::abs(found[0]), 1e-5) << "the run has to find something";
    for (size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(lens->value[i], found[i], 1e-6) << lens->name;
  }
}

// The window reports as much: InertialStates.ClaimLessOfWhatWasPerhapsNeverCalibrated.
TEST(Refine, ClaimsLessOfWhatWasPerhapsNeverCalibrated) {
  ForwardRun run(smallScene(2));
  run.options.imu_axes = {.gyroscope_sigma = 0.001, .uncalibrated_sigma = 0.0, .accelerometer_sigma = 0.0};
  const Refinement taken_for_calibrated = run.refined();
  run.options.imu_axes.uncalibrated_sigma = 0.007;
  const Refinement in_doubt = run.refined();
  ASSERT_TRUE(taken_for_calibrated.summary.has_covariance && in_doubt.summary.has_covariance);
  const FrameEstimate& believed = taken_for_calibrated.frames.back();
  const FrameEstimate& doubted = in_doubt.frames.back();
  for (int axis = 0; axis < 15; ++axis)
    EXPECT_GE(doubted.covariance(axis, axis), believed.covariance(axis, axis)) << axis;
  EXPECT_NEAR(doubted.covariance(3, 3) - believed.covariance(3, 3), std::pow(0.007, 2) - std::pow(0.001, 2),
              5e-7);
  EXPECT_GT(doubted.covariance(5, 5), 1.02 * believed.covariance(5, 5));
}

TEST(Refine, GivesTheSameBytesAgain) {
  const ForwardRun run(smallScene(2));
  const Refinement first = run.refined(), second = run.refined();
  for (size_t i = 0; i < first.frames.size(); ++i)
    ASSERT_EQ(first.frames[i].state.world_from_body.translation,
              second.frames[i].state.world_from_body.translation);
}

TEST(Refine, RefusesWhatMostObservationsContradict) {
  const ForwardRun run(smallScene(2));
  RefinementOptions strict;
  strict.max_outlier_share = -1.0;  // any share is too large
  const Refinement refinement = refine(run.scene.rig(), run.options, run.record, strict);
  EXPECT_FALSE(refinement.summary.usable());
  EXPECT_EQ(refinement.frames.back().state.world_from_body.translation,
            run.record.frames().back().state.world_from_body.translation);
}

TEST(Refine, RefusesARecordWithoutPoses) {
  const EstimatorLog record;
  EXPECT_FALSE(refine(testRig(2), {}, record).summary.usable());
}

}  // namespace
}  // namespace lodeline
