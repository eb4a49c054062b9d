#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lodeline/estimator/trials/disturbed_dive.h"
#include "lodeline/util/angles.h"

// Tests of what magnetic disturbances do to the heading and to its claimed sigma. The whole set of dives is
// measured by magnetic_harm_study.

namespace lodeline {
namespace {

DisturbedDive cave(FieldTrouble trouble, uint64_t seed) {
  DisturbedDive dive;
  dive.trouble = trouble;
  dive.seed = seed;
  dive.duration_s = 90.0;
  return dive;
}

// Iron turns the compass at the start by ten degrees and more.
TEST(MagnetometerHarm, ADisturbedStartKeepsTheClaimWideUntilNorthIsFound) {
  const DisturbedRun run = runDisturbedDive(cave(FieldTrouble::AtStart, 5), MagnetometerUse::Absolute);
  EXPECT_GT(std::abs(run.samples.front().error_rad), 5.0 * kDegree) << "the start is not disturbed";
  EXPECT_GT(run.errors.within_3_sigmas, 0.985);
  EXPECT_LT(std::abs(run.errors.north_end_rad), 0.5 * kDegree) << "north was not found later";
  // The way back leads to the iron again.
  const auto surest = std::min_element(
      run.samples.begin(), run.samples.end(),
      [](const HeadingSample& a, const HeadingSample& b) { return a.sigma_rad < b.sigma_rad; });
  EXPECT_LT(surest->sigma_rad, 1.0 * kDegree) << "nor claimed";
  EXPECT_LT(std::abs(surest->error_rad), 3.0 * surest->sigma_rad);
}

TEST(MagnetometerHarm, AnUndisturbedStartIsDoubtedForSomeMetresOnly) {
  const DisturbedRun run = runDisturbedDive(cave(FieldTrouble::None, 6), MagnetometerUse::Absolute);
  EXPECT_GT(run.samples.front().sigma_rad, 4.0 * kDegree) << "the first field was taken on trust";
  EXPECT_LT(run.samples.back().sigma_rad, 0.6 * kDegree);
  EXPECT_GT(run.errors.within_3_sigmas, 0.999);
}

// Iron every 8 m, magnetite in the walls, iron at the start, and all of these: no worse than without a
// magnetometer, because the first heading stays and north moves.
TEST(MagnetometerHarm, IronDoesNotBendThePath) {
  for (const FieldTrouble trouble :
       {FieldTrouble::Beside, FieldTrouble::Magnetite, FieldTrouble::AtStart, FieldTrouble::Together}) {
    const DisturbedDive dive = cave(trouble, 1);
    const DisturbedRun off = runDisturbedDive(dive, MagnetometerUse::Off);
    const DisturbedRun on = runDisturbedDive(dive, MagnetometerUse::Absolute);
    EXPECT_LT(on.errors.used_share, 0.98) << toString(trouble) << ": nothing was rejected";
    EXPECT_LT(on.errors.heading_rms_rad, 1.1 * off.errors.heading_rms_rad) << toString(trouble);
    EXPECT_LT(on.errors.position_rms_m, 1.1 * off.errors.position_rms_m) << toString(trouble);
    EXPECT_GT(on.errors.within_3_sigmas, 0.95) << toString(trouble);
  }
}

// Root mean square over three dives. Single dives differ by a factor from 0.8 to 2.
TEST(MagnetometerHarm, AMagnetThatIsPassedIsDoubted) {
  HeadingTrialOptions options;
  options.duration_s = 180.0;
  options.frame_rate_hz = 4.0;
  options.tracks = 30;
  options.estimator.magnetometer.use = MagnetometerUse::Absolute;
  options.trouble = FieldTrouble::Dipole;
  const auto squares = [&](double student_dof) {
    options.estimator.magnetometer.student_dof = student_dof;
    double sum = 0.0;
    for (options.seed = 1; options.seed <= 3; ++options.seed)
      sum += std::pow(runHeadingTrial(options).alignedRms(60.0), 2);
    return sum;
  };
  const double doubted = squares(MagnetometerOptions().student_dof), believed = squares(1e6);
  EXPECT_GT(std::sqrt(believed / doubted), 1.15) << "size and dip were not asked";
}

}  // namespace
}  // namespace lodeline
