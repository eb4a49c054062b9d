#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "lodeline/batch/loops/test_circuit.h"
#include "lodeline/batch/refine.h"

namespace lodeline {
namespace {

BatchCircuitOptions circuitOf(double radius_m) {
  BatchCircuitOptions options;
  options.radius_m = radius_m;
  return options;
}

/// Mean over the frames of the squared position error by its covariance. It is 1 where the claims are right.
/// The position of the first frames is known by definition.
double meanNees(const CircuitRun& run, const Refinement& refined) {
  constexpr size_t kFirst = 40;
  double sum = 0.0;
  for (size_t i = kFirst; i < refined.frames.size(); ++i) {
    const Vec3 error = refined.frames[i].state.world_from_body.translation - run.truth[i].translation;
    const Mat3 covariance = refined.frames[i].covariance.topLeftCorner<3, 3>();
    sum += error.dot(covariance.ldlt().solve(error)) / 3.0;
  }
  return sum / static_cast<double>(refined.frames.size() - kFirst);
}

/// Expects that loops, a share of which are wrong, leave at most `most` of the error of the batch solution.
void expectLessError(const CircuitRun& run, double wrong_share, bool are_tracked, double most) {
  const Refinement without = refine(run.rig, run.options, run.record);
  CircuitLoopOptions loops;
  loops.wrong_share = wrong_share;
  loops.are_tracked = are_tracked;
  const Refinement with = refine(run.rig, run.options, run.record, circuitLoops(run, loops));
  ASSERT_TRUE(without.summary.usable()) << without.summary.refusal;
  ASSERT_TRUE(with.summary.usable()) << with.summary.refusal;
  const double before_m = run.rootMeanSquare(without.frames), after_m = run.rootMeanSquare(with.frames);
  std::printf("forward %.1f mm, batch %.1f mm, with loops %.1f mm (%.2f); NEES %.2f and %.2f\n",
              1e3 * run.rootMeanSquare(run.record.frames()), 1e3 * before_m, 1e3 * after_m,
              after_m / before_m, meanNees(run, without), meanNees(run, with));
  EXPECT_LE(after_m, most * before_m);
  EXPECT_LT(meanNees(run, with), 1.5);
}

TEST(Loops, RemoveMostOfTheErrorOfACircuitThatIsSwumTwice) {
  expectLessError(CircuitRun(circuitOf(12.0)), 0.2, false, 0.25);
}

// Takes minutes; `make loops` runs it.
TEST(Loops, DISABLED_OfACircuitOf157Metres) {
  const CircuitRun run(circuitOf(25.0));
  for (const double wrong_share : {0.0, 0.2}) expectLessError(run, wrong_share, true, 0.25);
}

}  // namespace
}  // namespace lodeline
