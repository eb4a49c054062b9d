#include "lodeline/io/dives/depth_profile.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/io/dives/profile_time.h"

namespace lodeline {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class DepthProfileTest : public ::testing::Test {
 protected:
  DepthProfile read(const std::string& text) {
    return readDepthProfiles(folder_.write("p.csv", text), &diagnostics_).front();
  }
  std::vector<DepthProfile> readAll(const std::string& text, const char* name = "p.csv") {
    return readDepthProfiles(folder_.write(name, text), &diagnostics_);
  }
  void expectRefusal(const std::string& text, const char* says) {
    EXPECT_THAT([&] { read(text); }, ThrowsMessage<InputError>(HasSubstr(says)));
  }
  /// A header and twelve rows of a format that contains the index twice.
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
  const DepthProfile profile =
      read(rows("\"dive number\",\"date\",\"time\",\"max depth\",\"sample time "
                "(min)\",\"sample depth (m)\"\n",
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
  expectRefusal("", "no columns of time and depth");
  expectRefusal(rows("time,pressure\n", "{0},{0}\n"), "'depth [m]'");
  expectRefusal(rows("time,pressure [mbar]\n", "{0},{0}\n"), "1 bar is 10.2 m of fresh");
  expectRefusal("time,depth\n1,2\n2,3\n", "only 2 usable readings");
  EXPECT_THROW(readDepthProfiles("/nowhere.csv", &diagnostics_), InputError);
}

TEST_F(DepthProfileTest, TakesTheDepthOfTheMomentAndNoOther) {
  const auto expectDepths = [&](const std::string& header) {
    const DepthProfile profile = read(rows(header + "\n", "{0}0,90,80,{0}.5,70\n"));
    EXPECT_EQ(profile.readings.at(3).depth_m, 3.5) << header;
    EXPECT_EQ(profile.readings.at(3).time_s, 30.0) << header;
  };
  expectDepths("Time (s),Average Depth (m),Max Depth (m),Depth (m),Stop Depth (m)");
  expectDepths("Time (sec),avg_depth,Max Time,depth_m,First Stop Depth");
  expectDepths(
      "time [s],Mean Depth [m],Deco Ceiling Depth [m],Sample Depth "
      "[m],Depth [m]");
  expectDepths("Zeit (s),Mittlere Tiefe (m),max. Tiefe (m),Tiefe (m),Temperatur");
  expectRefusal(rows("Time (s),Average Depth (m)\n", "{0}0,{0}.5\n"), "Average Depth");
}

TEST_F(DepthProfileTest, KnowsOtherUnitsOfDepthAndRefusesUnknownOnes) {
  EXPECT_NEAR(read(rows("time [s],depth [cm]\n", "{0}0,{0}50\n")).readings[3].depth_m, 3.5, 1e-12);
  EXPECT_NEAR(read(rows("time [s],depth (feet)\n", "{0}0,{0}\n")).readings[3].depth_m, 3 * 0.3048, 1e-12);
  EXPECT_NEAR(read(rows("time [s],depth_mm\n", "{0}0,{0}000\n")).readings[3].depth_m, 3.0, 1e-12);
  EXPECT_NEAR(read(rows("time,depth\n", "0:{0:02},{0} ft\n")).readings[3].depth_m, 3 * 0.3048, 1e-12);
  EXPECT_FALSE(read(rows("time [s],depth\n", "{0}0,{0}\n")).has_unit);
  EXPECT_TRUE(read(rows("time [s],depth [m]\n", "{0}0,{0}\n")).has_unit);
  expectRefusal(rows("time [s],depth [fathom]\n", "{0}0,{0}\n"), "fathom");
  expectRefusal(rows("time [s],depth [bar]\n", "{0}0,{0}\n"), "known unit");
}

TEST_F(DepthProfileTest, ReadsQuotedDecimalCommas) {
  const std::string header =
      "\"dive number\",\"time\",\"sample time (min)\",\"sample depth "
      "(m)\",\"sample heartrate\"\n";
  const DepthProfile comma = read(rows(header, "\"7\",\"10:34:00\",\"0:{0:02}\",\"{0},2\",\n"));
  const DepthProfile point = read(rows(header, "\"7\",\"10:34:00\",\"0:{0:02}\",\"{0}.2\",\n"));
  ASSERT_EQ(comma.readings.size(), 12U);
  for (size_t i = 0; i < 12; ++i) EXPECT_EQ(comma.readings[i].depth_m, point.readings[i].depth_m);
  EXPECT_EQ(comma.readings[3].depth_m, 3.2);
}

TEST_F(DepthProfileTest, ReadsTheSecondHeaderOfAShearwater) {
  const auto text = [](const char* imperial) {
    return rows(std::string("Dive Number,Imperial Units,Start Date,Max Depth,Max Time\n60,") + imperial +
                    ",11/21/2026 10:34:00 AM,52.5,4\nTime (sec),Depth,First Stop "
                    "Depth,Time To Surface (min)\n",
                "{0}0,{0}.5,90,80\n");
  };
  const DepthProfile metres = read(text("False")), feet = read(text("True"));
  ASSERT_EQ(metres.readings.size(), 12U);
  EXPECT_EQ(metres.readings[3].depth_m, 3.5);
  EXPECT_EQ(metres.readings[3].time_s, 30.0);
  EXPECT_TRUE(metres.has_unit);
  EXPECT_NEAR(feet.readings[3].depth_m, 3.5 * 0.3048, 1e-12);
}

TEST_F(DepthProfileTest, ReadsASeabearWithoutTimes) {
  const DepthProfile profile = read(rows("//SEABEAR DIVING TECHNOLOGY\n//Surface pressure: 0.970 "
                                         "bar\n//Log interval: 5 s\n\nDepth;NDT;TTS\n"
                                         "1;1;1\n0;1;2\n\n",
                                         "{0}.5;\n") +
                                    "12.5;200;0\n");
  ASSERT_EQ(profile.readings.size(), 13U);
  EXPECT_EQ(profile.readings[3].depth_m, 3.5);
  EXPECT_EQ(profile.readings[3].time_s - profile.readings[0].time_s, 15.0);
  expectRefusal(rows("Depth;NDT\n", "{0};1\n"), "no time");
}

TEST_F(DepthProfileTest, ReadsLogsInXml) {
  const auto ssrf = readAll(rows("<divelog program='subsurface' version='3'><dives><dive "
                                 "number='1'><divecomputer>\n",
                                 "<sample time='{0}:30 min' depth='{0}.25 m' temp='9.0 C'/>\n") +
                                rows("</divecomputer></dive><dive number='2'><divecomputer "
                                     "model='x'>\n",
                                     "<sample time='0:{0:02} min' depth='{0}.5 m'/>\n") +
                                "</divecomputer></dive></dives></divelog>\n",
                            "dives.ssrf");
  ASSERT_EQ(ssrf.size(), 2U);
  EXPECT_EQ(ssrf[0].readings[3].time_s, 210.0);
  EXPECT_EQ(ssrf[0].readings[3].depth_m, 3.25);
  EXPECT_EQ(ssrf[1].readings[3].time_s, 3.0);
  EXPECT_EQ(ssrf[1].dive, "lines 15 to 26");
  const auto udcf = readAll(rows("<profile "
                                 "udcf='1'><units>Imperial</"
                                 "units><repgroup><dive><samples><delta>30</delta>",
                                 "<d>{0}</d>") +
                            "</samples></dive></repgroup></profile>");
  EXPECT_EQ(udcf.at(0).readings[3].time_s, 90.0);
  EXPECT_NEAR(udcf[0].readings[3].depth_m, 3 * 0.3048, 1e-12);
  const auto uddf = readAll(rows("<?xml "
                                 "version='1.0'?><uddf><profiledata><repetitiongroup><dive><samples>",
                                 "<waypoint><depth>{0}.5</depth><divetime>{0}0</divetime></"
                                 "waypoint>") +
                            "</samples></dive></repetitiongroup></profiledata></uddf>");
  EXPECT_EQ(uddf.at(0).readings[3].time_s, 30.0);
  EXPECT_EQ(uddf[0].readings[3].depth_m, 3.5);
  expectRefusal("<html><body/></html>", "<html>");
  expectRefusal("<divelog><dives><dive>", "damaged XML");
}

TEST_F(DepthProfileTest, PassesOverWildTimesAndGoesOn) {
  const auto expectPassedOver = [&](const std::string& row, bool is_first) {
    Diagnostics fresh;
    const std::string good = rows("", "{0}0,{0}\n");
    const std::string text =
        "time [s],depth [m]\n" +
        (is_first ? row + "\n" + good : good.substr(0, 25) + row + "\n" + good.substr(25));
    const auto profiles = readDepthProfiles(folder_.write("w.csv", text), &fresh);
    ASSERT_EQ(profiles.size(), 1U) << row;
    EXPECT_EQ(profiles[0].readings.size(), 12U) << row;
    EXPECT_EQ(profiles[0].readings.back().time_s, 110.0) << row;
    EXPECT_EQ(fresh.count("profile_line"), 1) << row;
  };
  for (const char* row : {"1e308,3", "-1e308,3", "1000000000,3", "1e400,3", "nan,3"}) {
    expectPassedOver(row, true);
    expectPassedOver(row, false);
  }
}

TEST_F(DepthProfileTest, PassesOverMarksOfMissingDepths) {
  for (const char* mark : {"65535", "6553.5", "999.9", "-1", "-999", "0", "1e30"}) {
    Diagnostics fresh;
    std::string text = "time [s],depth [m]\n";
    for (int i = 0; i < 30; ++i)
      text +=
          fmt::format("{},{}\n", 10 * i, i == 7 || i == 20 ? mark : fmt::format("{:.1f}", 12.0 + 0.3 * i));
    const DepthProfile profile = readDepthProfiles(folder_.write("m.csv", text), &fresh).front();
    EXPECT_EQ(profile.readings.size(), 28U) << mark;
    EXPECT_EQ(fresh.count("profile_line"), 2) << mark;
    for (const DepthReading& reading : profile.readings) EXPECT_GE(reading.depth_m, 12.0) << mark;
  }
}

TEST_F(DepthProfileTest, SplitsALogIntoItsDives) {
  const std::string one = rows("", "{0}0,{0}\n"), later = rows("", "90{0:02}0,{0}\n");
  const auto reset = readAll("time [s],depth [m]\n" + one + one);
  ASSERT_EQ(reset.size(), 2U);
  EXPECT_EQ(reset[0].dive, "lines 2 to 13");
  EXPECT_EQ(reset[1].dive, "lines 14 to 25");
  EXPECT_EQ(readAll("time [s],depth [m]\n" + one + later).size(), 2U);
  EXPECT_EQ(
      readAll(rows("dive number,time [s],depth [m]\n", "1,{0}0,{0}\n") + rows("", "2,2{0:02}0,{0}\n")).size(),
      2U);
  EXPECT_EQ(diagnostics_.count("profile_line"), 0);
}

TEST_F(DepthProfileTest, ReadsTimesInTheirUsualForms) {
  const auto steps = [&](const std::string& header, const std::string& row) {
    const DepthProfile profile = read(rows(header, row));
    EXPECT_EQ(profile.readings.size(), 12U) << header;
    return profile.readings.at(3).time_s - profile.readings.at(0).time_s;
  };
  EXPECT_EQ(steps("time,depth\n", "{0}0,{0}\n"), 30.0);
  EXPECT_EQ(steps("time_ms,depth\n", "{0}000,{0}\n"), 3.0);
  EXPECT_EQ(steps("time,depth\n", "17950000{0:02}000,{0}\n"),
            3.0);  // milliseconds since 1970
  EXPECT_EQ(steps("time (min),depth\n", "{0},{0}\n"), 180.0);
  EXPECT_EQ(steps("time (h:mm),depth\n", "0:{0:02},{0}\n"), 180.0);
  EXPECT_EQ(steps("date,time,depth\n", "2026-11-21,10:34:{0:02},{0}\n"), 3.0);
  EXPECT_EQ(steps("date,time,depth\n", "11/21/2026,10:{0:02} AM,{0}\n"), 180.0);
  EXPECT_EQ(steps("Datum;Tiefe\n", "21.11.2026 10:34:{0:02};{0},5\n"), 3.0);
  std::string latest_first = "time,depth\n";
  for (int i = 11; i >= 0; --i) latest_first += fmt::format("{}0,{}.5\n", i, i);
  EXPECT_EQ(read(latest_first).readings.at(3).depth_m, 3.5);
  const DepthProfile midnight =
      read(rows("time,depth\n", "23:59:{0:02},{0}\n") + rows("", "00:00:{0:02},{0}\n"));
  EXPECT_EQ(midnight.readings.size(), 24U);
  EXPECT_EQ(midnight.readings[12].time_s - midnight.readings[0].time_s, 60.0);
}

TEST(ProfileTime, IsReadInTheUsualNotations) {
  EXPECT_EQ(parseProfileTime("1:15"), 75.0);
  EXPECT_EQ(parseProfileTime("125:15"), 7515.0);
  EXPECT_EQ(parseProfileTime("1:02:03.5"), 3723.5);
  EXPECT_EQ(parseProfileTime("3:04:05 PM"), 54245.0);
  EXPECT_EQ(parseProfileTime("12:00:05 AM"), 5.0);
  EXPECT_EQ(parseProfileTime("1970-01-02T00:00:01Z"), 86401.0);
  EXPECT_EQ(parseProfileTime("1970-01-02"), 86400.0);
  EXPECT_EQ(parseProfileTime("2026-11-21 12:00:00"), 1795262400.0);
  EXPECT_EQ(parseProfileTime("21.11.2026 12:00"), 1795262400.0);
  EXPECT_EQ(parseProfileTime("11/21/2026 12:00:00 PM"), 1795262400.0);
  EXPECT_EQ(parseProfileTime("21/11/2026 12:00:00"), 1795262400.0);
  EXPECT_EQ(parseProfileTime("2026-11-21T12:00:00.25+02:00"), 1795255200.25);
  EXPECT_EQ(parseProfileTime("2026-11-21T12:00-0430"), 1795262400.0 + 4.5 * 3600.0);
  EXPECT_EQ(parseProfileTime("2026-11-21 12:00:00 CEST"), 1795262400.0);
  EXPECT_EQ(parseProfileTime("10:00:05 EST"), 36005.0);
  for (const char* text : {"", "x", "UTC", "12 UTC", "75.5", "1:75", "1:2:3:4", "2026-13-21T12:00:00Z",
                           "2026-11-21T12:00:00+x", "nan", "-1:10", "32.1.2026"}) {
    EXPECT_FALSE(parseProfileTime(text)) << text;
  }
}

}  // namespace
}  // namespace lodeline
