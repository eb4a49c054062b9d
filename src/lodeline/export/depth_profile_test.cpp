#include "lodeline/export/depth_profile.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/base/error.h"
#include "lodeline/evaluation/test_trajectories.h"
#include "lodeline/export/profile_time.h"

namespace lodeline {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class DepthProfileTest : public ::testing::Test {
 protected:
  DepthProfile read(const std::string& text) {
    return readDepthProfile(folder_.write("p.csv", text), &diagnostics_);
  }
  void expectRefusal(const std::string& text, const char* says) {
    EXPECT_THAT([&] { read(text); }, ThrowsMessage<InputError>(HasSubstr(says)));
  }
  /// A header and twelve rows of a format with the index in it twice.
  static std::string rows(const std::string& header, const std::string& row) {
    std::string text = header;
    for (int i = 0; i < 12; ++i) text += fmt::format(fmt::runtime(row), i);
    return text;
  }

  test::TemporaryFolder folder_;
  Diagnostics diagnostics_;
};

TEST_F(DepthProfileTest, KnowsTheUnitsOfItsHeader) {
  const DepthProfile metres = read(rows("time [s],depth [m]\n", "{0}0,{0}.5\n"));
  ASSERT_EQ(metres.readings.size(), 12U);
  EXPECT_EQ(metres.readings[3].time_s, 30.0);
  EXPECT_EQ(metres.readings[3].depth_m, 3.5);
  EXPECT_NEAR(metres.resolution_m, 1.0, 1e-9);
  EXPECT_NEAR(read(rows("Elapsed (min);Temp;Depth (ft)\r\n", "{0};21,5;{0},5\r\n")).readings[3].depth_m,
              3.5 * 0.3048, 1e-12);
  EXPECT_EQ(read(rows("Elapsed (min);Temp;Depth (ft)\r\n", "{0};21,5;{0},5\r\n")).readings[3].time_s, 180.0);
  EXPECT_NEAR(read(rows("#timestamp [ns],depth [m]\n", "17952552{0:02}050000000,{0}\n")).readings[3].time_s,
              1795255203.05, 1e-6);
  EXPECT_EQ(diagnostics_.ranked().size(), 0U);
}

TEST_F(DepthProfileTest, TakesTheColumnsOfEachSample) {
  const DepthProfile profile = read(
      rows("\"dive number\",\"date\",\"time\",\"max depth\",\"sample time (min)\",\"sample depth (m)\"\n",
           "\"1\",\"2026-11-21\",\"12:00:00\",\"30\",\"0:{0:02}\",\"{0}.25\"\n"));
  ASSERT_EQ(profile.readings.size(), 12U);
  EXPECT_EQ(profile.readings[7].time_s, 7.0);
  EXPECT_EQ(profile.readings[7].depth_m, 7.25);
}

TEST_F(DepthProfileTest, ReadsWithoutAHeaderAndHeights) {
  EXPECT_EQ(read(rows("", "{0}, -{0}.5\n")).readings[2].depth_m, 2.5);
  const DepthProfile dated = read(rows("", "2026-11-21T12:00:{0:02}Z\t{0}\n"));
  EXPECT_EQ(dated.readings[2].time_s, 1795262402.0);
}

TEST_F(DepthProfileTest, PassesOverWhatItCannotUse) {
  const DepthProfile profile = read(rows("time,depth\nx,1\n5,nan\n", "{0}0,{0}\n") + "20,3\n900,\n");
  EXPECT_EQ(profile.readings.size(), 12U);
  EXPECT_EQ(diagnostics_.count("profile_line"), 4);
}

TEST_F(DepthProfileTest, RefusesWhatIsNoProfile) {
  expectRefusal("", "only 0 usable readings");
  expectRefusal(rows("time,pressure\n", "{0},{0}\n"), "'depth [m]'");
  expectRefusal("time,depth\n1,2\n2,3\n", "only 2 usable readings");
  EXPECT_THROW(readDepthProfile("/nowhere.csv", &diagnostics_), InputError);
}

TEST(ProfileTime, IsReadInTheUsualNotations) {
  EXPECT_EQ(parseProfileTime("75.5", 1.0), 75.5);
  EXPECT_EQ(parseProfileTime("1.5", 60.0), 90.0);
  EXPECT_EQ(parseProfileTime("1:15", 60.0), 75.0);
  EXPECT_EQ(parseProfileTime("125:15", 1.0), 7515.0);
  EXPECT_EQ(parseProfileTime("1:02:03.5", 1.0), 3723.5);
  EXPECT_EQ(parseProfileTime("1970-01-02T00:00:01Z", 1.0), 86401.0);
  EXPECT_EQ(parseProfileTime("2026-11-21 12:00:00", 1.0), 1795262400.0);
  EXPECT_EQ(parseProfileTime("2026-11-21T12:00:00.25+02:00", 1.0), 1795255200.25);
  EXPECT_EQ(parseProfileTime("2026-11-21T12:00-0430", 1.0), 1795262400.0 + 4.5 * 3600.0);
  for (const char* text :
       {"", "x", "1:75", "1:2:3:4", "2026-13-21T12:00:00Z", "2026-11-21T12:00:00+x", "nan", "-1:10"}) {
    EXPECT_FALSE(parseProfileTime(text, 1.0)) << text;
  }
}

}  // namespace
}  // namespace lodeline
