#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/magnetometer/iron/reading_screen.h"
#include "lodeline/magnetometer/iron/sphere_coverage.h"
#include "lodeline/magnetometer/iron/test_cloud.h"

// Screening and coverage of readings before a calibration.

namespace lodeline {
namespace {

std::vector<MagnetometerSample> samplesOf(const std::vector<Vec3>& fields) {
  std::vector<MagnetometerSample> samples;
  for (size_t i = 0; i < fields.size(); ++i) {
    samples.push_back({Time::fromNanoseconds(static_cast<int64_t>(i) * 20'000'000), fields[i]});
  }
  return samples;
}

TEST(ReadingScreen, DropsRepetitionsNansAndDisorder) {
  std::vector<Vec3> fields = test::cloud({}, 100);
  std::vector<MagnetometerSample> samples;
  for (const MagnetometerSample& sample : samplesOf(fields)) {
    samples.push_back(sample);
    samples.push_back({sample.time + Duration::fromSeconds(0.01), sample.field_M});
  }
  samples[10].field_M.y() = std::nan("");
  samples[20].time = samples[3].time;
  Diagnostics diagnostics;
  const ReadingScreen screen = screenReadings(samples, &diagnostics);
  EXPECT_EQ(screen.not_finite, 1);
  EXPECT_EQ(screen.disordered, 1);
  EXPECT_EQ(screen.repeated, 98);  // partners of the two others, without equal readings before them
  EXPECT_EQ(screen.usable.size(), 100u);
  EXPECT_EQ(diagnostics.count("magnetometer_repeated"), 1);
  EXPECT_EQ(diagnostics.count("magnetometer_frozen"), 0);
}

TEST(ReadingScreen, ReportsAFrozenSensor) {
  std::vector<Vec3> fields = test::cloud({}, 100);
  fields.insert(fields.begin() + 50, 200, fields[50]);
  Diagnostics diagnostics;
  const ReadingScreen screen = screenReadings(samplesOf(fields), &diagnostics);
  EXPECT_EQ(screen.usable.size(), 100u);
  EXPECT_NEAR(screen.longest_frozen_s, 4.0, 0.05);
  EXPECT_EQ(diagnostics.count("magnetometer_frozen"), 1);
}

TEST(ReadingScreen, RemovesReadingsAtTheEndOfTheRange) {
  test::CloudTruth truth;
  truth.sigma = 0.01;
  std::vector<Vec3> fields = test::cloud(truth, 600);
  int clipped = 0;
  for (Vec3& field : fields) {
    clipped += field.x() > 0.9;
    field.x() = std::min(field.x(), 0.9);
  }
  Diagnostics diagnostics;
  EXPECT_EQ(screenReadings(samplesOf(fields), &diagnostics).saturated, clipped);
  EXPECT_EQ(diagnostics.count("magnetometer_saturated"), 1);
}

TEST(ReadingScreen, LeavesCoarseButHealthyReadings) {
  test::CloudTruth truth;
  truth.sigma = 0.01;
  std::vector<Vec3> fields = test::cloud(truth, 600);
  for (Vec3& field : fields) field = (field * 40.0).array().round().matrix() / 40.0;
  Diagnostics diagnostics;
  EXPECT_EQ(screenReadings(samplesOf(fields), &diagnostics).saturated, 0);
}

TEST(SphereCoverage, CountsBinsOfEqualArea) {
  EXPECT_EQ(SphereCoverage().share(), 0.0);
  test::CloudTruth truth;
  truth.correction.setIdentity();
  truth.hard_iron.setZero();
  EXPECT_EQ(SphereCoverage(test::cloud(truth, 2000)).share(), 1.0);
  truth.least_cosine = 0.0;
  EXPECT_NEAR(SphereCoverage(test::cloud(truth, 2000)).share(), 0.5, 1e-9);
  SphereCoverage every;
  for (int zone = 0; zone < SphereCoverage::kZones; ++zone) {
    for (int sector = 0; sector < SphereCoverage::kSectors; ++sector) {
      every.add(SphereCoverage::middle(zone, sector));
      EXPECT_EQ(every.count(zone, sector), 1);
    }
  }
}

}  // namespace
}  // namespace lodeline
