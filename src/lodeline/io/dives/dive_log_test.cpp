#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/io/dives/depth_profile.h"
#include "lodeline/io/dives/dive_choice.h"
#include "lodeline/io/logs/test_logs.h"

// Logs that say where each dive begins, and the choice among their dives.

namespace lodeline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class DiveLogTest : public ::testing::Test {
 protected:
  std::vector<DepthProfile> read(const std::string& text, const char* name = "log.xml") {
    return readDepthProfiles(folder_.write(name, text), &diagnostics_);
  }
  void expectRefusal(const std::string& text, const std::string& says) {
    EXPECT_THAT([&] { read(text); }, ThrowsMessage<InputError>(HasSubstr(says))) << text.substr(0, 200);
  }

  test::TemporaryFolder folder_;
  Diagnostics diagnostics_;
};

/// A DL7 log of one dive of 60 minutes with its times in a unit.
std::string dl7(const std::string& depth_unit, const std::string& rows) {
  return "FSH|^~\\&{}|ANST01^12X456^A|ZXU|20180106163705|\r\nZRH|^~\\&{}|||" + depth_unit +
         "|ThM|C|bar|L|\r\nZDH|1|7|I|QS|20180102101000|27|11|FO2|||\r\nZDP{\r\n" + rows +
         "ZDP}\r\nZDT|1|7|10.0|20180102111000|25||\r\n";
}

TEST_F(DiveLogTest, ReadsDl7InMinutesAndInSeconds) {
  const DepthProfile minutes =
      read(dl7("MSWG", "|0.00|0.5|1|||\r\n|30.50|12.25||||\r\n|60.00|0|||\r\n")).at(0);
  ASSERT_EQ(minutes.readings.size(), 3U);
  EXPECT_EQ(minutes.readings[1].time_s, 1830.0);
  EXPECT_EQ(minutes.readings[1].depth_m, 12.25);
  EXPECT_EQ(minutes.label.number, "7");
  EXPECT_EQ(minutes.label.start, "2018-01-02 10:10:00");
  EXPECT_EQ(diagnostics_.count("profile_time"), 0);
  // Whole minutes are minutes where the end of the dive says so.
  EXPECT_EQ(read(dl7("MFWG", "|0|1|\r\n|30|12|\r\n|60|0|\r\n")).at(0).readings[2].time_s, 3600.0);
  EXPECT_EQ(diagnostics_.count("profile_time"), 0);
  EXPECT_EQ(read(dl7("MFWG", "|0|1|\r\n|1800|12|\r\n|3500|0|\r\n")).at(0).readings[1].time_s, 1800.0);
  EXPECT_EQ(diagnostics_.count("profile_time"), 1);
}

TEST_F(DiveLogTest, ReadsTheUnitOfDl7AndNamesItsBadLines) {
  const DepthProfile feet = read(dl7("FSWG", "|0.0|10|\r\n|30.5|100|\r\n|60.0|5|\r\n")).at(0);
  EXPECT_NEAR(feet.readings[1].depth_m, 30.48, 1e-9);
  EXPECT_EQ(feet.unit, "ft");
  expectRefusal(dl7("PSI", "|0.0|10|\r\n|30.5|100|\r\n|60.0|5|\r\n"), "'PSI'");
  expectRefusal(dl7("", "|0.0|10|\r\n|30.5|100|\r\n|60.0|5|\r\n"), "no known unit");
  expectRefusal(dl7("MSWG", "|0.0|10|\r\n|x|100|\r\n|60.0|5|\r\n"), "log.xml:6: 'x|100'");
  expectRefusal("FSH|a|\nZRH|a|||MSWG|\nZDP{\n|0|1|\n", "log.xml:4: a profile without a dive");
  expectRefusal("FSH|a|\nZRH|a|||MSWG|\nZDH|1|1|I|QS|20180101101000|\n", "without a depth profile");
}

std::string repeated(const std::string& row) {
  std::string text;
  for (int i = 0; i < 12; ++i) text += fmt::format(fmt::runtime(row), i);
  return text;
}

TEST_F(DiveLogTest, ReadsBothXmlFormatsOfSuunto) {
  const auto manager = read(
      "<?xml version='1.0'?><SUUNTO><MSG><DEVICEMODEL>Vyper</DEVICEMODEL><DIVENUMBER>12</DIVENUMBER>"
      "<DATE>03.02.2013</DATE><TIME>08:21:50</TIME><MAXDEPTH>30</MAXDEPTH>" +
      repeated("<SAMPLE><SAMPLETIME>{0}0</SAMPLETIME><DEPTH>{0},25</DEPTH><BOOKMARK/></SAMPLE>") +
      "<SAMPLE><SAMPLETIME>55</SAMPLETIME><DEPTH>0</DEPTH><BOOKMARK>Surface</BOOKMARK></SAMPLE></MSG></"
      "SUUNTO>");
  ASSERT_EQ(manager.at(0).readings.size(), 12U);
  EXPECT_EQ(manager[0].readings[3].time_s, 30.0);
  EXPECT_EQ(manager[0].readings[3].depth_m, 3.25);
  EXPECT_EQ(manager[0].label.start, "2013-02-03 08:21:50");
  const auto dm5 = read(
      "<Dive xmlns='http://schemas.datacontract.org/2004/07/Suunto.Diving.Dal' "
      "xmlns:i='http://www.w3.org/2001/XMLSchema-instance'><AvgDepth>6</AvgDepth><DiveSamples>" +
      repeated("<Dive.Sample><Ceiling i:nil='true'/><Depth>{0}.5</Depth><Time>{0}0</Time></Dive.Sample>") +
      "<Dive.Sample><Depth i:nil='true'/><Time>500</Time></Dive.Sample></DiveSamples>"
      "<StartTime>2020-01-04T09:16:54</StartTime></Dive>");
  ASSERT_EQ(dm5.at(0).readings.size(), 12U);
  EXPECT_EQ(dm5[0].readings[3].depth_m, 3.5);
  EXPECT_EQ(dm5[0].label.start, "2020-01-04 09:16:54");
}

TEST_F(DiveLogTest, ReadsAnArchiveOfLogs) {
  const auto log = [](int number) {
    return fmt::format("<SUUNTO><MSG><DIVENUMBER>{}</DIVENUMBER>", number) +
           repeated("<SAMPLE><SAMPLETIME>{0}0</SAMPLETIME><DEPTH>{0}</DEPTH></SAMPLE>") + "</MSG></SUUNTO>";
  };
  test::ZipBytes archive;
  archive.add("1.xml", log(41)).add("2.xml", log(42), false).add("readme.txt", "nothing");
  const auto dives = read(archive.bytes(), "dives.sde");
  ASSERT_EQ(dives.size(), 2U);
  EXPECT_EQ(chooseDive(dives, "42").at(0).label.number, "42");
  EXPECT_NE(dives[0].dive_number, dives[1].dive_number);
  test::ZipBytes empty;
  empty.add("readme.txt", "nothing");
  expectRefusal(empty.bytes(), "an archive without a dive log");
}

TEST_F(DiveLogTest, TellsTheLineOfDamagedXml) {
  expectRefusal("<divelog>\n<dives>\n<dive number='1'>\n</dives>\n</divelog>\n", "log.xml:4: damaged XML");
  expectRefusal("<divelog>\n<dives><dive>", "damaged XML");
  expectRefusal("<divelog><dives><dive><sample time='0:10 min' depth='3 fathom'/></dive></dives></divelog>",
                "log.xml:1: depths in 'fathom'");
  expectRefusal("<profile udcf='1'><units>Royal</units></profile>", "'Royal'");
}

TEST_F(DiveLogTest, ExpandsNoEntities) {
  std::string bomb = "<!DOCTYPE d [<!ENTITY a0 '0123456789'>\n";
  for (int i = 1; i < 30; ++i) {
    bomb += fmt::format("<!ENTITY a{} '", i);
    for (int j = 0; j < 10; ++j) bomb += fmt::format("&a{};", i - 1);
    bomb += "'>\n";
  }
  bomb += "]>\n<divelog><dives><dive number='1'>&a29;";
  expectRefusal(bomb + "</dive></dives></divelog>", "log.xml");
  expectRefusal(
      "<!DOCTYPE d [<!ENTITY x SYSTEM 'file:///etc/hostname'>]><divelog><dives><dive>&x;</dive></dives>"
      "</divelog>",
      "entities");
  // In attributes, too.
  expectRefusal(
      "<!DOCTYPE d [<!ENTITY x 'y'>]><divelog><dives><dive><sample time='0:1 min' depth='&x; m'/>"
      "</dive></dives></divelog>",
      "entities");
}

std::string twoDives(const std::string& first, const std::string& second) {
  const std::string samples = repeated("<sample time='{0}:00 min' depth='{0}.5 m'/>");
  return "<divelog><dives><dive " + first + ">" + samples + "</dive><dive " + second + "><divecomputer>" +
         samples + "</divecomputer><divecomputer>" + samples + "</divecomputer></dive></dives></divelog>";
}

TEST_F(DiveLogTest, WantsAChoiceAmongDives) {
  const auto dives = read(twoDives("number='8' date='2026-11-21' time='10:34:00'",
                                   "number='9' date='2026-11-21' time='14:02:30'"));
  EXPECT_THAT([&] { chooseDive(dives, ""); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("log.xml has 2 dives"), HasSubstr("--dive 8 "),
                                              HasSubstr("2026-11-21 14:02:30"), HasSubstr("11 min"),
                                              HasSubstr("11.5 m"))));
  EXPECT_EQ(chooseDive(dives, "8").size(), 1U);
  EXPECT_EQ(chooseDive(dives, "9").size(), 2U) << "both computers of the dive";
  EXPECT_EQ(chooseDive(dives, "2026-11-21 14").at(0).label.number, "9");
  EXPECT_EQ(chooseDive(dives, "2026-11-21T10:34").at(0).label.number, "8");
  for (const char* wrong : {"1", "2026-11-21", "2025-01-01", "10:34"})
    EXPECT_THAT([&] { chooseDive(dives, wrong); }, ThrowsMessage<UsageError>(HasSubstr("--dive 8 ")))
        << wrong;
}

TEST_F(DiveLogTest, CountsDivesWhereTheLogNumbersThemNot) {
  for (const auto& [first, second] : {std::pair("", ""), {"number='3'", "number='3'"}}) {
    const auto dives = read(twoDives(first, second));
    EXPECT_EQ(chooseDive(dives, "1").size(), 1U);
    EXPECT_EQ(chooseDive(dives, "2").size(), 2U);
  }
  const auto one = read("time [s],depth [m]\n" + repeated("{0}0,{0}\n"), "table.csv");
  EXPECT_EQ(chooseDive(one, "").size(), 1U);
  EXPECT_THAT([&] { chooseDive(one, "2"); }, ThrowsMessage<UsageError>(HasSubstr("0 such dives")));
}

}  // namespace
}  // namespace lodeline
