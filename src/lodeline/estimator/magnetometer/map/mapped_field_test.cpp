#include "lodeline/estimator/magnetometer/map/mapped_field.h"

#include <gtest/gtest.h>

#include "lodeline/estimator/trials/heading_trial.h"

namespace lodeline {
namespace {

HeadingTrial mapTrial(FieldTrouble trouble, bool uses_map) {
  HeadingTrialOptions options;
  options.duration_s = 100.0;
  options.frame_rate_hz = 4.0;
  options.tracks = 30;
  options.trouble = trouble;
  options.estimator.magnetometer.use = MagnetometerUse::Absolute;
  options.estimator.magnetometer.map = uses_map;
  return runHeadingTrial(options);
}

TEST(MappedField, ChangesNothingInTheEarthsField) {
  const HeadingTrial with = mapTrial(FieldTrouble::None, true), without = mapTrial(FieldTrouble::None, false);
  EXPECT_EQ(with.findings.count("magnetic_map_begun"), 0);
  ASSERT_EQ(with.samples.size(), without.samples.size());
  for (size_t i = 0; i < with.samples.size(); ++i) {
    ASSERT_EQ(with.samples[i].error_rad, without.samples[i].error_rad) << i;
    ASSERT_EQ(with.samples[i].sigma_rad, without.samples[i].sigma_rad) << i;
  }
}

TEST(MappedField, BeginsAtIronInThePassageAndDoesNoHarm) {
  const HeadingTrial with = mapTrial(FieldTrouble::Dipole, true),
                     without = mapTrial(FieldTrouble::Dipole, false);
  EXPECT_EQ(with.findings.count("magnetic_map_begun"), 1);
  EXPECT_EQ(without.findings.count("magnetic_map_begun"), 0);
  EXPECT_LT(with.rms(20.0), 1.05 * without.rms(20.0));
  EXPECT_LT(with.largest(20.0), 1.1 * without.largest(20.0));
}

}  // namespace
}  // namespace lodeline
