#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lodeline/batch/batch_problem.h"
#include "lodeline/batch/loops/test_circuit.h"
#include "lodeline/batch/refine.h"

namespace lodeline {
namespace {

/// A circuit of 157 m swum twice, and its solution without loops. Made once for all tests.
struct SolvedCircuit {
  CircuitRun run;
  Refinement without;

  SolvedCircuit() : run(CircuitOptions{}), without(refine(run.rig, run.options, run.record)) {}
  Refinement with(const LoopClosures& loops) const { return refine(run.rig, run.options, run.record, loops); }
  static const SolvedCircuit& get() {
    static const SolvedCircuit circuit;
    return circuit;
  }
};

double largestNormalizedError(const CircuitRun& run, const std::vector<FrameEstimate>& frames) {
  double largest = 0.0;
  for (size_t i = 0; i < frames.size(); ++i) {
    const Vec3 error = frames[i].state.world_from_body.translation - run.truth[i].translation;
    for (int axis = 0; axis < 3; ++axis)
      largest = std::max(largest, std::abs(error[axis]) / std::sqrt(frames[i].covariance(axis, axis) + 1e-6));
  }
  return largest;
}

TEST(Loops, BringTheSecondLapOntoTheFirst) {
  const SolvedCircuit& circuit = SolvedCircuit::get();
  const CircuitRun& run = circuit.run;
  const LoopClosures loops = circuitLoops(run, {});
  const Refinement with = circuit.with(loops);
  ASSERT_TRUE(circuit.without.summary.usable()) << circuit.without.summary.refusal;
  ASSERT_TRUE(with.summary.usable()) << with.summary.refusal;
  EXPECT_GT(with.summary.loop_links_used, 9 * with.summary.loop_links / 10);
  const double without_m = run.rootMeanSquare(circuit.without.frames);
  const double with_m = run.rootMeanSquare(with.frames);
  RecordProperty("without_mm", static_cast<int>(1e3 * without_m));
  RecordProperty("with_mm", static_cast<int>(1e3 * with_m));
  EXPECT_GT(without_m, 0.3) << "there must be an error to remove";
  EXPECT_LT(with_m, 0.25 * without_m);
}

// The inflation grows along the way. After a loop it counts from the place that the loop leads to.
TEST(Loops, AreInTheReportedCovariance) {
  const SolvedCircuit& circuit = SolvedCircuit::get();
  const CircuitRun& run = circuit.run;
  const Refinement with = circuit.with(circuitLoops(run, {}));
  ASSERT_TRUE(with.summary.has_covariance);
  EXPECT_LT(largestNormalizedError(run, with.frames), 3.0);
  const auto sigmaAt_m = [&](const Refinement& refinement, double time_s) {
    const Time time = refinement.frames.front().time + Duration::fromSeconds(time_s);
    const auto frame = std::find_if(refinement.frames.begin(), refinement.frames.end(),
                                    [&](const FrameEstimate& estimate) { return estimate.time >= time; });
    return std::sqrt(frame->covariance.topLeftCorner<3, 3>().trace());
  };
  const double back_s = run.lap_s + 20.0;
  EXPECT_LT(sigmaAt_m(with, back_s), 2.0 * sigmaAt_m(with, 20.0) + 0.02) << "back at the start";
  EXPECT_LT(sigmaAt_m(with, back_s), 0.2 * sigmaAt_m(circuit.without, back_s));
  EXPECT_GT(sigmaAt_m(with, 0.5 * run.lap_s), 3.0 * sigmaAt_m(with, back_s)) << "far from the start";
}

TEST(Loops, TakeCornersThatWereNotTracked) {
  const SolvedCircuit& circuit = SolvedCircuit::get();
  CircuitLoopOptions options;
  options.are_tracked = false;
  const Refinement with = circuit.with(circuitLoops(circuit.run, options));
  ASSERT_TRUE(with.summary.usable()) << with.summary.refusal;
  EXPECT_GT(with.summary.loop_links_used, 0);
  EXPECT_LT(circuit.run.rootMeanSquare(with.frames),
            0.35 * circuit.run.rootMeanSquare(circuit.without.frames));
}

TEST(Loops, LoseWrongObservations) {
  const SolvedCircuit& circuit = SolvedCircuit::get();
  CircuitLoopOptions options;
  const Refinement right = circuit.with(circuitLoops(circuit.run, options));
  options.wrong_share = 0.2;
  const Refinement some_wrong = circuit.with(circuitLoops(circuit.run, options));
  ASSERT_TRUE(some_wrong.summary.usable()) << some_wrong.summary.refusal;
  EXPECT_LT(some_wrong.summary.loop_links_used, some_wrong.summary.loop_links);
  EXPECT_LT(circuit.run.rootMeanSquare(some_wrong.frames), 1.1 * circuit.run.rootMeanSquare(right.frames));
}

TEST(Loops, GiveTheSameBytesOnAnyNumberOfCores) {
  const SolvedCircuit& circuit = SolvedCircuit::get();
  const LoopClosures loops = circuitLoops(circuit.run, {});
  const Refinement on_all = circuit.with(loops);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Refinement on_one = circuit.with(loops);
  for (size_t i = 0; i < on_all.frames.size(); ++i) {
    ASSERT_EQ(on_one.frames[i].state.world_from_body.translation,
              on_all.frames[i].state.world_from_body.translation);
    ASSERT_EQ(on_one.frames[i].covariance, on_all.frames[i].covariance);
  }
}

// Loop observations of other dives.
TEST(Loops, ChangeNothingWhereTheRecordHasNoSuchTracks) {
  const SolvedCircuit& circuit = SolvedCircuit::get();
  LoopClosures loops;
  const Time time = circuit.run.record.frames().back().time;
  loops.observations.push_back({1'000'000'000, time, time, circuit.run.seen.back().front().observation});
  const BatchProblem plain(circuit.run.rig, circuit.run.options, circuit.run.record);
  const BatchProblem looped(circuit.run.rig, circuit.run.options, circuit.run.record, loops, 4.0);
  EXPECT_EQ(looped.links(), 0);
  EXPECT_EQ(looped.observations(), plain.observations());
  EXPECT_EQ(looped.emptyMatrix().bytes(), plain.emptyMatrix().bytes());
}

TEST(Loops, KeepTheSkylineNarrow) {
  const SolvedCircuit& circuit = SolvedCircuit::get();
  const CircuitRun& run = circuit.run;
  const BatchProblem plain(run.rig, run.options, run.record);
  const BatchProblem looped(run.rig, run.options, run.record, circuitLoops(run, {}), 64.0);
  EXPECT_GT(looped.linksUsed(), 100);
  RecordProperty("plain_MB", static_cast<int>(1e-6 * static_cast<double>(plain.emptyMatrix().bytes())));
  RecordProperty("looped_MB", static_cast<int>(1e-6 * static_cast<double>(looped.emptyMatrix().bytes())));
  // Both laps, and both directions from the start, are side by side: four times as wide as one lap.
  EXPECT_LT(looped.emptyMatrix().bytes(), 8 * plain.emptyMatrix().bytes());
}

}  // namespace
}  // namespace lodeline
