#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/io/dives/depth_profile.h"
#include "lodeline/io/dives/dive_choice.h"
#include "lodeline/util/files/test_data.h"

// Logs of dive computers. The expected values were read from the files by eye.

namespace lodeline {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class RealDiveLogs : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto folder = testData("dive_logs");
    if (!folder) GTEST_SKIP() << missingTestData("dive_logs");
    folder_ = *folder;
  }

  std::vector<DepthProfile> read(const char* name) {
    std::vector<DepthProfile> profiles = readDepthProfiles(folder_ / name, &diagnostics_);
    for (const DepthProfile& profile : profiles) EXPECT_EQ(profile.unit, "m") << name;
    return profiles;
  }

  /// Checks a reading, and the greatest depth of the only dive.
  void expectDive(const char* name, size_t count, const DepthReading& first, const DepthReading& last,
                  double greatest_m) {
    const std::vector<DepthProfile> profiles = read(name);
    ASSERT_EQ(profiles.size(), 1U) << name;
    const std::vector<DepthReading>& readings = profiles[0].readings;
    ASSERT_EQ(readings.size(), count) << name;
    EXPECT_EQ(readings.front().time_s, first.time_s) << name;
    EXPECT_EQ(readings.front().depth_m, first.depth_m) << name;
    EXPECT_EQ(readings.back().time_s, last.time_s) << name;
    EXPECT_EQ(readings.back().depth_m, last.depth_m) << name;
    double deepest_m = 0.0;
    for (const DepthReading& reading : readings) deepest_m = std::max(deepest_m, reading.depth_m);
    EXPECT_EQ(deepest_m, greatest_m) << name;
  }

  std::filesystem::path folder_;
  Diagnostics diagnostics_;
};

TEST_F(RealDiveLogs, HaveTheDepthsOfTheirFiles) {
  expectDive("DL7.zxu", 4, {0, 1}, {3600, 0}, 10.0);
  expectDive("TestComma.csv", 26, {0, 0}, {1460, 0}, 20.0);
  expectDive("TestDiveDivelogsDE.udcf", 65, {0, 0}, {1920, 0}, 24.69);
}

TEST_F(RealDiveLogs, OfSeabearHaveTheirTimes) {
  expectDive("TestDiveSeabearH3_0002SBDT.CSV", 207, {0, 1.0}, {1030, 0}, 69.9);
  // The last second has twelve rows; the first of them counts.
  expectDive("TestDiveSeabearHUDC.csv", 92, {1, 1.2}, {452, 0.1}, 40.0);
  expectDive("TestDiveSeabearT1_0004SBDT.CSV", 984, {0, 1.2}, {983, 0.1}, 70.1);
}

TEST_F(RealDiveLogs, OfSubsurfaceHaveNumbersAndDates) {
  const auto suunto = read("TestDiveDM5.xml");
  ASSERT_EQ(suunto.size(), 4U);
  const DepthProfile second = chooseDive(suunto, "2").at(0);
  EXPECT_EQ(second.label.start, "2013-02-02 13:44:21");
  ASSERT_EQ(second.readings.size(), 184U);
  EXPECT_EQ(second.readings.front().depth_m, 1.21);
  EXPECT_EQ(second.readings.back().time_s, 3660.0);
  EXPECT_EQ(second.readings.back().depth_m, 1.67);
  const auto dives = read("SampleDivesV2.ssrf");
  EXPECT_THAT([&] { chooseDive(dives, ""); }, ThrowsMessage<InputError>(HasSubstr("--dive 2 ")));
  const auto first = chooseDive(dives, "2010-12-04 10:38");
  ASSERT_EQ(first.size(), 1U);
  EXPECT_EQ(first[0].label.number, "2");
  ASSERT_EQ(first[0].readings.size(), 30U);
  EXPECT_EQ(first[0].readings[14].time_s, 450.0);
  EXPECT_EQ(first[0].readings[14].depth_m, 10.97);
  EXPECT_THAT([&] { read("TwoTimesTwo.ssrf"); },
              ThrowsMessage<InputError>(HasSubstr("without a depth profile")));
}

}  // namespace
}  // namespace lodeline
