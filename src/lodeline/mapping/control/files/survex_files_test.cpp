#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <random>

#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/mapping/control/files/survex_files.h"
#include "lodeline/mapping/control/test_control.h"

// Tests of Survex' files, against Survex' own programs where they are installed.

namespace lodeline {
namespace {

using test::errorOf;
using ::testing::HasSubstr;

bool isSurvexInstalled() {
  return std::system("command -v cavern >/dev/null && command -v dump3d >/dev/null") == 0;
}

std::string textOf(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// A survey with nested surveys, long labels, splays, an anonymous station and an entrance.
const char* const kSurvey = R"(*title "The cave"
*begin cave
*entrance 1
*fix 1 100.5 200.25 10
*date 2026.11.28
1 2 30.00 90 -10
2 3 15.50 180 -20
*begin a_survey_with_a_name_that_takes_more_than_fifteen_characters_in_the_label
1 2 12.34 45 0
2 another_long_station_name 5.67 315 5
*end a_survey_with_a_name_that_takes_more_than_fifteen_characters_in_the_label
*equate 3 a_survey_with_a_name_that_takes_more_than_fifteen_characters_in_the_label.1
*flags splay
3 .. 2.00 0 0
3 ... 1.00 90 0
*flags not splay
*data passage station left right up down
1 1 1 1 1
2 2 2 2 2
*end cave
)";

class SurvexFilesTest : public ::testing::Test {
 protected:
  std::filesystem::path survey3d() {
    folder_.write("cave.svx", kSurvey);
    const std::string command = "cd '" + folder_.path().string() + "' && cavern -q cave.svx >/dev/null 2>&1";
    return std::system(command.c_str()) == 0 ? folder_.path() / "cave.3d" : std::filesystem::path();
  }
  /// A .3d file with these bytes after a header of version 8.
  std::filesystem::path with(const std::string& items, const std::string& version = "v8", char flags = 0) {
    return folder_.write("made.3d",
                         "Survex 3D Image File\n" + version + "\ntitle\n@1371300355\n" + flags + items);
  }

  test::TemporaryFolder folder_;
  ControlReadOptions options_;
};

TEST_F(SurvexFilesTest, ReadsTheStationsThatDump3dLists) {
  if (!isSurvexInstalled()) GTEST_SKIP() << "cavern not found: apt-get install survex";
  const std::filesystem::path file = survey3d();
  ASSERT_TRUE(isSurvex3d(file));
  const SurvexSurvey survey = readSurvex3d(file);
  EXPECT_EQ(survey.title, "The cave");
  const std::string dump = folder_.path() / "dump.txt";
  ASSERT_EQ(std::system(("dump3d '" + file.string() + "' > '" + dump + "'").c_str()), 0);
  std::map<std::string, Vec3> expected;
  std::ifstream lines(dump);
  for (std::string line; std::getline(lines, line);) {
    char name[200];
    Vec3 position;
    if (std::sscanf(line.c_str(), "NODE %lf %lf %lf [%199[^]]]", &position.x(), &position.y(), &position.z(),
                    name) == 4)
      expected[name] = position;
  }
  ASSERT_EQ(expected.size(), 6u) << textOf(dump);
  std::map<std::string, Vec3> read;
  for (const SurvexStation& station : survey.stations) read[station.name] = station.position;
  EXPECT_EQ(read.size(), expected.size());
  for (const auto& [name, position] : expected) {
    ASSERT_TRUE(read.count(name)) << name;
    EXPECT_LT((read[name] - position).norm(), 1e-9) << name;
  }
  const auto first = std::find_if(survey.stations.begin(), survey.stations.end(),
                                  [](const SurvexStation& station) { return station.name == "cave.1"; });
  ASSERT_NE(first, survey.stations.end());
  EXPECT_TRUE(first->is_entrance);
  EXPECT_TRUE(first->is_fixed);
}

TEST_F(SurvexFilesTest, ReadsTheSameStationsFromText) {
  if (!isSurvexInstalled()) GTEST_SKIP() << "cavern not found: apt-get install survex";
  const std::filesystem::path file = survey3d();
  const std::filesystem::path text = folder_.path() / "cave.pos";
  if (std::system(
          ("survexport --pos '" + file.string() + "' '" + text.string() + "' >/dev/null 2>&1").c_str()) != 0)
    GTEST_SKIP() << "survexport of this Survex writes no .pos";
  const SurvexSurvey binary = readSurvex3d(file), written = readSurvexPositions(text);
  ASSERT_FALSE(written.stations.empty());
  size_t found = 0;
  for (const SurvexStation& station : written.stations) {
    for (const SurvexStation& other : binary.stations) {
      if (other.name != station.name) continue;
      EXPECT_LT((other.position - station.position).norm(), 0.01) << station.name;
      ++found;
    }
  }
  EXPECT_EQ(found, binary.stations.size());
}

TEST_F(SurvexFilesTest, RefusesEveryShortenedFile) {
  if (!isSurvexInstalled()) GTEST_SKIP() << "cavern not found: apt-get install survex";
  const std::string bytes = textOf(survey3d());
  for (size_t size = 0; size < bytes.size(); ++size) {
    const std::filesystem::path file = folder_.write("short.3d", bytes.substr(0, size));
    EXPECT_THROW(readSurvex3d(file), InputError) << size;
  }
  std::mt19937 random(1);
  for (int i = 0; i < 300; ++i) {
    std::string changed = bytes;
    changed[random() % changed.size()] = static_cast<char>(random());
    try {
      readSurvex3d(folder_.write("changed.3d", changed));
    } catch (const InputError&) {  // or another survey
    }
  }
}

TEST_F(SurvexFilesTest, ReadsLabelsOfEveryForm) {
  const std::string position("\x64\0\0\0\xc8\0\0\0\x9c\xff\xff\xff", 12);
  const std::string items = std::string("\x82\x05") + "abc.1" + position          // appended: 5 characters
                            + "\x82\x11" + "2" + position                         // one away, one appended
                            + std::string("\x82\0\x01\x02", 4) + "34" + position  // lengths in two bytes
                            + std::string("\xa2\x01x", 3) + position              // anonymous
                            + std::string("\xc2\x01x", 3) + position              // on a wall
                            + std::string("\x01\0\0", 3);
  const SurvexSurvey survey = readSurvex3d(with(items));
  ASSERT_EQ(survey.stations.size(), 3u);
  EXPECT_EQ(survey.stations[0].name, "abc.1");
  EXPECT_EQ(survey.stations[1].name, "abc.2");
  EXPECT_EQ(survey.stations[2].name, "abc.34");
  EXPECT_LT((survey.stations[0].position - Vec3(1, 2, -1)).norm(), 1e-12);
}

TEST_F(SurvexFilesTest, NamesWhatIsWrong) {
  const auto refusal = [&](const std::filesystem::path& file) {
    return errorOf([&] { readSurvex3d(file); });
  };
  EXPECT_THAT(refusal(with("", "v7")), HasSubstr("the format is 'v7'; version 8 is read"));
  EXPECT_THAT(refusal(with("", "v8", '\x80')), HasSubstr("extended elevation"));
  EXPECT_THAT(refusal(with("\x22")), HasSubstr("unknown item 0x22"));
  EXPECT_THAT(refusal(with("\x82\x41"
                           "a")),
              HasSubstr("a label is shortened by more than it has"));
  EXPECT_THAT(refusal(folder_.write("other.3d", "Survex 3D Imagine")), HasSubstr("is no .3d file"));
  EXPECT_THAT(refusal(folder_.path() / "missing.3d"), HasSubstr("cannot be read"));
  const auto text = folder_.write("a.pos", "( Easting, Northing, Altitude ) Station\n( 1.0, 2.0 ) a\n");
  EXPECT_THAT(errorOf([&] { readSurvexPositions(text); }), HasSubstr("a.pos:2: '( 1.0, 2.0 ) a' is no"));
  EXPECT_THAT(errorOf([&] { readSurvexPositions(folder_.write("b.pos", "( Easting, )\n")); }),
              HasSubstr("no station"));
}

TEST_F(SurvexFilesTest, StationsAreControlPointsRelativeToTheOrigin) {
  Diagnostics diagnostics;
  const auto file =
      folder_.write("a.pos",
                    "( Easting, Northing, Altitude ) Station\n"
                    "( 450100.00, 2267000.50, -4.00 ) cave.1\n( 450101.00, 2267000.50, -4.00 )\n");
  EXPECT_THAT(errorOf([&] { readControl(file, options_, &diagnostics); }),
              HasSubstr("station cave.1: is 2311 km"));
  options_.grid_origin = Vec3(450000, 2267000, 6);
  const ControlSet set = readControl(file, options_, &diagnostics);
  ASSERT_EQ(set.points.size(), 1u);
  EXPECT_LT((set.points[0].position->position - Vec3(100, 0.5, -10)).norm(), 1e-9);
  EXPECT_EQ(set.points[0].kind, ControlKind::Station);
  EXPECT_EQ(set.points[0].name, "cave.1");
}

}  // namespace
}  // namespace lodeline
