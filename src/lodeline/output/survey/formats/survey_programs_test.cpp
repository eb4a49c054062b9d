#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <regex>

#include "lodeline/output/survey/formats/test_survey_programs.h"

// Tests of the exported files with Survex's cavern and Therion.

namespace lodeline {
namespace {

using test::devilsEye;
using test::expectAt;
using test::Stations;
using test::SurveyPrograms;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;

TEST_F(SurveyPrograms, PutEveryStationOnItsPose) {
  LODELINE_NEEDS_PROGRAM("cavern", "survex");
  LODELINE_NEEDS_PROGRAM("therion", "therion");
  const DiveMap map = write(test::windingDive(400.0), devilsEye());
  EXPECT_GT(map.survey.stations.size(), 60U);
  expectBothAt(map);
}

TEST_F(SurveyPrograms, PutEveryStationOnItsPoseToAMillimetre) {
  LODELINE_NEEDS_PROGRAM("cavern", "survex");
  LODELINE_NEEDS_PROGRAM("therion", "therion");
  const DiveMap map = write(test::windingDive(400.0), devilsEye());
  const Vec3 first = map.place->grid(Vec3::Zero());
  // A copy of the line, 100 times larger and from zero: centimetres of the programs are then tenths of a
  // millimetre.
  replaceIn(map.name + ".svx", R"(\*cs [^\n]*\n)", "");
  replaceIn(map.name + ".svx", R"(\*fix 0 [^\n]*)", "*fix 0 0 0 0\n*units dx dy dz 100 metres");
  replaceIn(map.name + ".th", "    data cartesian", "    units dx dy dz 100 metres\n    data cartesian");
  const Stations survex = cavern(map.name), therion_stations = therion(map.name);
  ASSERT_EQ(survex.size(), map.survey.stations.size());
  ASSERT_EQ(therion_stations.size(), map.survey.stations.size());
  for (size_t i = 0; i < map.survey.stations.size(); ++i) {
    const Vec3 expected = map.place->grid(map.survey.stations[i].position_ENU) - first;
    const int index = static_cast<int>(i);
    EXPECT_LT((survex.at(index) / 100.0 - expected).norm(), 1e-3) << "station " << i;
    EXPECT_LT(((therion_stations.at(index) - first) / 100.0 - expected).norm(), 1e-3) << "station " << i;
  }
}

TEST_F(SurveyPrograms, AgreeInTheSouthAndFarFromTheZonesMiddle) {
  LODELINE_NEEDS_PROGRAM("cavern", "survex");
  LODELINE_NEEDS_PROGRAM("therion", "therion");
  DiveMapOptions options = devilsEye();
  options.entrance = GeodeticPosition{-37.72, 142.9, 30.0};
  options.crs = "UTM55S";  // not its own zone: convergence 2.5 degrees
  const DiveMap map = write(test::windingDive(), options);
  expectBothAt(map);
}

// Grid differences for Survex, true ones for Therion; feet are converted to metres of the same grid.
TEST_F(SurveyPrograms, PutEveryStationOnItsPoseOnNationalGrids) {
  LODELINE_NEEDS_PROGRAM("cavern", "survex");
  LODELINE_NEEDS_PROGRAM("therion", "therion");
  struct Case {
    const char* crs;
    GeodeticPosition place;
  };
  for (const Case& c : {Case{"EPSG:6372", {20.32, -87.39, 5.0}},    // Mexico: convergence 5.2 degrees
                        Case{"EPSG:6438", test::kDevilsEye},        // Florida, US feet
                        Case{"EPSG:2154", {44.3, 1.7, 120.0}},      // Lambert-93
                        Case{"EPSG:2193", {-41.0, 172.5, 700.0}},   // New Zealand
                        Case{"EPSG:6405", {33.5, -112.0, 300.0}},   // Arizona, international feet
                        Case{"EPSG:3765", {45.0, 15.5, 300.0}}}) {  // Croatia
    DiveMapOptions options = devilsEye();
    options.entrance = c.place;
    options.crs = c.crs;
    const DiveMap map = write(test::windingDive(), options);
    SCOPED_TRACE(c.crs);
    ASSERT_TRUE(map.place->gridDescription().therion_name);
    expectBothAt(map);
  }
}

// Survex supports any grid in metres, Therion only grids with a code.
TEST_F(SurveyPrograms, UseTheUtmZoneWhereTherionCannotUseTheGrid) {
  LODELINE_NEEDS_PROGRAM("cavern", "survex");
  LODELINE_NEEDS_PROGRAM("therion", "therion");
  DiveMapOptions options = devilsEye();
  options.entrance = GeodeticPosition{6.5, -1.0, 200.0};
  options.crs = "EPSG:2136";  // Ghana's grid in its national foot
  const DiveMap map = write(test::windingDive(), options);
  expectAt(cavern(map.name), map);
  options.crs = "auto";
  options.name = "unused";
  Diagnostics diagnostics;
  expectAt(therion(map.name), makeDiveMap(test::windingDive(), options, {}, &diagnostics));
}

// Therion turns grids wrongly whose longitudes do not count from Greenwich, and lacks a grid file for
// Krovak's.
TEST_F(SurveyPrograms, UseTheUtmZoneWhereTherionWouldTurnTheGrid) {
  LODELINE_NEEDS_PROGRAM("therion", "therion");
  for (const auto& [crs, place] : {std::pair<const char*, GeodeticPosition>{"EPSG:27572", {44.3, 1.7, 120.0}},
                                   {"EPSG:5514", {49.4, 16.7, 300.0}}}) {
    SCOPED_TRACE(crs);
    DiveMapOptions options = devilsEye();
    options.entrance = place;
    options.crs = crs;
    const DiveMap map = write(test::windingDive(), options);
    options.crs = "auto";
    options.name = "unused";
    Diagnostics diagnostics;
    expectAt(therion(map.name), makeDiveMap(test::windingDive(), options, {}, &diagnostics));
  }
}

TEST_F(SurveyPrograms, JoinDivesThatBeginAtOnePlace) {
  LODELINE_NEEDS_PROGRAM("cavern", "survex");
  LODELINE_NEEDS_PROGRAM("therion", "therion");
  std::vector<DiveMap> maps;
  for (const char* name : {"first", "second", "deeper"}) {
    DiveMapOptions options = devilsEye();
    options.name = name;
    if (options.name == "deeper") options.start_depth_m = 4.0;
    maps.push_back(write(test::windingDive(), options));
  }
  writeProject(maps, "cave", "A cave", MapFormat::Survex, folder_.path());
  writeProject(maps, "cave", "A cave", MapFormat::Therion, folder_.path());
  const test::OutsideRun survex = test::runIn(folder_.path(), "LC_ALL=C.UTF-8 cavern cave.svx");
  EXPECT_EQ(survex.exit_code, 0) << survex.output;
  EXPECT_THAT(survex.output, Not(AnyOf(HasSubstr("warning"), HasSubstr("error"))));
  const test::OutsideRun joined = test::runIn(folder_.path(), "therion cave.thconfig");
  EXPECT_EQ(joined.exit_code, 0) << joined.output;
  EXPECT_THAT(joined.output, Not(AnyOf(HasSubstr("warning"), HasSubstr("error --"))));
  // A loop known to the user: two dives in one cave.
  writeOutput(folder_.path() / "all.th",
              "encoding utf-8\nsurvey cave\n input first.th\n input second.th\n centreline\n"
              "  equate 0@first 0@second\n  equate 11@first 11@second\n endcentreline\nendsurvey\n");
  writeOutput(folder_.path() / "all.thconfig", "encoding utf-8\nsource all.th\nexport model -o all.lox\n");
  const test::OutsideRun loop = test::runIn(folder_.path(), "therion all.thconfig");
  EXPECT_EQ(loop.exit_code, 0) << loop.output;
  EXPECT_THAT(loop.output, HasSubstr("average loop error"));
}

// A run without a covariance does not have exact positions.
TEST_F(SurveyPrograms, TakeNoZeroVarianceForCertainty) {
  RunFolder run = test::windingDive();
  const Vec3 kept = run.uncertainties[200].covariance.diagonal().cwiseSqrt();
  for (size_t i = 201; i < run.uncertainties.size(); ++i) run.uncertainties[i].covariance.setZero();
  run.uncertainties.back().covariance(0, 0) = -1.0;
  Diagnostics diagnostics;
  const DiveMap map = makeDiveMap(run, devilsEye(), {}, &diagnostics);
  EXPECT_EQ(diagnostics.count("sigma_not_positive"), 1);
  const double legs = std::sqrt(static_cast<double>(map.survey.legs()));
  EXPECT_LT((map.survey.leg_sigma_ENU * legs - kept).norm(), 1e-9);
  for (PositionUncertainty& u : run.uncertainties) u.covariance.setZero();
  const DiveMap assumed = makeDiveMap(run, devilsEye(), {}, &diagnostics);
  EXPECT_EQ(diagnostics.count("sigma_assumed"), 1);
  EXPECT_NEAR(assumed.survey.leg_sigma_ENU.x() * legs, 0.01 * assumed.survey.length_m(), 1e-9);
}

TEST_F(SurveyPrograms, TakeAnEntranceThatIsKnownExactly) {
  LODELINE_NEEDS_PROGRAM("cavern", "survex");
  LODELINE_NEEDS_PROGRAM("therion", "therion");
  DiveMapOptions options = devilsEye();
  options.entrance_sigma_m = 0.0;
  options.entrance_height_sigma_m = 0.0;
  expectBothAt(write(test::windingDive(), options));
}

TEST_F(SurveyPrograms, TakeMagneticNorthTurnedByTheDeclination) {
  LODELINE_NEEDS_PROGRAM("cavern", "survex");
  LODELINE_NEEDS_PROGRAM("therion", "therion");
  RunFolder run = test::windingDive();
  const DiveMap expected = write(run, devilsEye());
  // The same dive in a run whose north is magnetic north.
  run.heading_reference = HeadingReference::Magnetic;
  const double declination = findNorth(run.heading_reference, test::kDevilsEye, "2026-11-21", {}).turn_rad;
  for (StampedPose& pose : run.trajectory.poses) {
    pose.world_from_body.translation = turnedClockwise(pose.world_from_body.translation, -declination);
  }
  write(run, devilsEye());
  expectBothAt(expected);
}

TEST_F(SurveyPrograms, TakeALocalMap) {
  LODELINE_NEEDS_PROGRAM("cavern", "survex");
  LODELINE_NEEDS_PROGRAM("therion", "therion");
  RunFolder run = test::windingDive();
  run.heading_reference = HeadingReference::Start;
  run.landmarks.clear();
  DiveMapOptions options;
  options.name = "Höhle 7";
  options.title = "the \"back\" way; %x\n*fix 0 1 2 3\xff";
  options.team = {"A\nB", "Jean Claude van Dijk", "O'Neil", "A/B/C", "", " "};
  options.start_depth_m = 3.0;
  const DiveMap map = write(run, options);
  EXPECT_EQ(map.name, "H__hle_7");
  expectBothAt(map);
}

TEST_F(SurveyPrograms, SpreadTheMisclosureOfAClosedDive) {
  LODELINE_NEEDS_PROGRAM("cavern", "survex");
  LODELINE_NEEDS_PROGRAM("therion", "therion");
  RunFolder run = test::windingDive(60.0);
  // The way back along the same path, with a drift of 0.6 m at its end.
  const std::vector<StampedPose> way = run.trajectory.poses;
  for (size_t i = 1; i < way.size(); ++i) {
    StampedPose pose = way[way.size() - 1 - i];
    pose.time = way.back().time + (way.back().time - pose.time);
    pose.world_from_body.translation.x() +=
        0.6 * static_cast<double>(i) / static_cast<double>(way.size() - 1);
    run.trajectory.poses.push_back(pose);
  }
  DiveMapOptions options = devilsEye();
  options.is_closed = true;
  const DiveMap map = write(run, options);
  EXPECT_NEAR(misclosure(map.survey).end_from_start_ENU.norm(), 0.6, 1e-6);
  const int last = static_cast<int>(map.survey.stations.size()) - 1;
  const Stations survex = cavern(map.name);
  EXPECT_LT((survex.at(0) - survex.at(last)).norm(), 1e-9);
  const Stations therion_stations = therion(map.name);
  // Half of the drift is corrected in the middle.
  const int middle = last / 2;
  EXPECT_LT((survex.at(middle) - therion_stations.at(middle)).cwiseAbs().maxCoeff(), 0.011);
  const Vec3 measured = map.place->grid(map.survey.stations[static_cast<size_t>(middle)].position_ENU);
  EXPECT_NEAR((survex.at(middle) - measured).norm(), 0.3, 0.05);
}

TEST_F(SurveyPrograms, SeeSplaysWhereTheWallsAre) {
  LODELINE_NEEDS_PROGRAM("cavern", "survex");
  const DiveMap map = write(test::windingDive(), devilsEye());
  cavern(map.name);
  const std::string dump = test::runIn(folder_.path(), "dump3d " + map.name + ".3d").output;
  static const std::regex kSplay(R"(LINE (\S+) (\S+) (\S+) \[[^\]]*\] STYLE=NORMAL SPLAY)");
  std::vector<Vec3> seen;
  for (std::sregex_iterator line(dump.begin(), dump.end(), kSplay), end; line != end; ++line) {
    seen.emplace_back(std::stod((*line)[1]), std::stod((*line)[2]), std::stod((*line)[3]));
  }
  size_t count = 0;
  for (const SurveyStation& station : map.survey.stations) {
    for (const Vec3& splay : station.splays_ENU) {
      ++count;
      const Vec3 expected = map.place->grid(splay);
      EXPECT_TRUE(
          std::any_of(seen.begin(), seen.end(), [&](const Vec3& s) { return (s - expected).norm() < 0.01; }));
    }
  }
  EXPECT_EQ(seen.size(), count);
  EXPECT_GT(count, 100U);
  // The whole passage is one tube of cross-sections.
  size_t tubes = 0;
  for (size_t at = dump.find("XSECT_END"); at != std::string::npos; at = dump.find("XSECT_END", at + 1))
    ++tubes;
  EXPECT_EQ(tubes, 1U);
}

}  // namespace
}  // namespace lodeline
