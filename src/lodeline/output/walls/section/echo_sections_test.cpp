#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lodeline/output/walls/section/wall_sections.h"
#include "simulation/dive/dive_world.h"
#include "simulation/sensors/sonar_model.h"

// Sections by the scanning sonar of a simulated dive against the exact surface of its cave.

namespace lodeline {
namespace {

struct SonarDive {
  Dive dive;
  std::shared_ptr<const RenderWorld> world;
  std::vector<Vec3> echoes;
  Survey survey;

  explicit SonarDive(const SonarErrors& errors, const Scenario& of = scenario())
      : dive(makeDive(of)), world(buildWorld(dive)) {
    const RangeFunction range = [this](const Vec3& origin, const Vec3& direction) {
      return world->scene.range(origin, direction);
    };
    const Rigid3& body_from_sonar = dive.errors.truth.rig.sonar->body_from_sonar;
    SonarModel sonar(dive.motion, body_from_sonar, range, errors, 1);
    std::vector<Vec3> positions;
    for (double t = 0.0; t < dive.motion.duration_s(); t += 0.05) {
      const Rigid3 world_from_body = dive.motion.at(t).world_from_body;
      positions.push_back(world_from_body.translation);
      const std::optional<SonarSample> echo = sonar.measure(t);
      if (!echo) continue;
      const Vec3 echo_S = echo->range_m * Vec3(std::cos(echo->angle_rad), std::sin(echo->angle_rad), 0.0);
      echoes.push_back(world_from_body * (body_from_sonar * echo_S));
    }
    for (const size_t i : chooseStations(positions, {}))
      survey.stations.push_back({{}, positions[i], {}, {}});
  }

  static Scenario scenario() {
    ScenarioChanges changes;
    changes.metres = 30.0;
    changes.no_images = true;
    return makeScenario("cave1_short", changes);
  }

  std::optional<double> trueRadius(const SectionPlane& plane, double angle_rad) const {
    return world->scene.range(plane.origin,
                              std::cos(angle_rad) * plane.right + std::sin(angle_rad) * plane.above);
  }
};

SonarErrors goodSonar() {
  SonarErrors errors;
  errors.noise_m = 0.03;
  errors.dropout_share = 0.1;
  errors.spurious_share = 0.05;
  return errors;
}

/// The dive of the tests, made once.
const SonarDive& sonarDive() {
  static const SonarDive dive(goodSonar());
  return dive;
}

double medianOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values.empty() ? NAN : values[values.size() / 2];
}

TEST(EchoSections, EqualThePassageOfTheSimulator) {
  const SonarDive& dive = sonarDive();
  const std::vector<StationWalls> walls = echoesAtStations(dive.echoes, dive.survey, {});
  ASSERT_EQ(walls.size(), dive.survey.stations.size());
  ASSERT_GE(walls.size(), 4u);
  std::vector<double> errors_m, area_ratios;
  for (const StationWalls& wall : walls) {
    double true_area_m2 = 0.0;
    const size_t sectors = wall.outline.radii_m.size();
    for (size_t i = 0; i < sectors; ++i) {
      const std::optional<double> radius_m = dive.trueRadius(wall.across, wall.outline.angle_rad(i));
      if (!radius_m) continue;
      true_area_m2 += std::numbers::pi / static_cast<double>(sectors) * *radius_m * *radius_m;
      if (wall.outline.radii_m[i]) errors_m.push_back(std::abs(*wall.outline.radii_m[i] - *radius_m));
    }
    if (wall.outline.area_m2) area_ratios.push_back(*wall.outline.area_m2 / true_area_m2);
  }
  RecordProperty("median_error_m", std::to_string(medianOf(errors_m)));
  RecordProperty("median_area_ratio", std::to_string(medianOf(area_ratios)));
  EXPECT_GE(2 * area_ratios.size(), walls.size());
  EXPECT_LT(medianOf(errors_m), 0.15);
  EXPECT_NEAR(medianOf(area_ratios), 1.0, 0.1);
}

TEST(EchoSections, GiveTheSurveyItsDistances) {
  const SonarDive& dive = sonarDive();
  Survey survey = dive.survey;
  takeSections(echoesAtStations(dive.echoes, survey, {}), 16, &survey);
  std::vector<double> errors_m;
  const std::vector<PassageSection> sections = passageSections(survey.stations);
  for (size_t i = 0; i < sections.size(); ++i) {
    const SectionPlane plane = verticalPlane(sections[i]);
    const PassageSize& size = survey.stations[i].passage;
    const std::optional<double> known[] = {size.right, size.up, size.left, size.down};
    for (int quarter = 0; quarter < 4; ++quarter) {
      const std::optional<double> radius_m = dive.trueRadius(plane, 0.5 * std::numbers::pi * quarter);
      if (radius_m && known[quarter]) errors_m.push_back(std::abs(*known[quarter] - *radius_m));
    }
  }
  RecordProperty("median_error_m", std::to_string(medianOf(errors_m)));
  EXPECT_GE(errors_m.size(), 3 * sections.size());
  EXPECT_LT(medianOf(errors_m), 0.2);
}

TEST(EchoSections, GiveTheSurveyItsSplays) {
  const SonarDive& dive = sonarDive();
  Survey survey = dive.survey;
  takeSections(echoesAtStations(dive.echoes, survey, {}), 16, &survey);
  std::vector<double> errors_m;
  for (const SurveyStation& station : survey.stations) {
    EXPECT_LE(station.splays_ENU.size(), 16u);
    for (const Vec3& splay : station.splays_ENU) {
      const Vec3 way = splay - station.position_ENU;
      const std::optional<double> range_m = dive.world->scene.range(station.position_ENU, way.normalized());
      if (range_m) errors_m.push_back(std::abs(way.norm() - *range_m));
    }
  }
  RecordProperty("median_error_m", std::to_string(medianOf(errors_m)));
  EXPECT_GE(errors_m.size(), 8 * survey.stations.size());
  EXPECT_LT(medianOf(errors_m), 0.2);
}

// A vehicle above an open sea floor: the floor has a distance, and nothing else has one.
TEST(EchoSections, MeasureNoPassageAboveAnOpenFloor) {
  ScenarioChanges changes;
  changes.metres = 15.0;
  changes.no_images = true;
  const SonarDive dive(goodSonar(), makeScenario("auv", changes));
  ASSERT_FALSE(dive.echoes.empty());
  const std::vector<StationWalls> walls = echoesAtStations(dive.echoes, dive.survey, {});
  const std::vector<PassageSection> sections = passageSections(dive.survey.stations);
  for (size_t i = 0; i < walls.size(); ++i) {
    EXPECT_FALSE(walls[i].outline.area_m2) << i;
    EXPECT_FALSE(walls[i].size.up) << i;
    const std::optional<double> below_m =
        dive.trueRadius(verticalPlane(sections[i]), -0.5 * std::numbers::pi);
    if (walls[i].size.down && below_m) {
      EXPECT_NEAR(*walls[i].size.down, *below_m, 0.4) << i;
    }
  }
}

/// A ring of echoes about the origin, in the plane across x.
std::vector<Vec3> ring(double radius_m, double x, int count) {
  std::vector<Vec3> echoes;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * std::numbers::pi * (i + 0.5) / count;
    echoes.emplace_back(x, radius_m * std::cos(angle), radius_m * std::sin(angle));
  }
  return echoes;
}

Survey alongX() {
  Survey survey;
  for (const double x : {0.0, 5.0}) survey.stations.push_back({{}, Vec3(x, 0.0, 0.0), {}, {}});
  return survey;
}

TEST(EchoSections, AreClosedPolygonsAndMeasureARing) {
  const std::vector<StationWalls> walls = echoesAtStations(ring(2.0, 0.1, 720), alongX(), {});
  ASSERT_TRUE(walls[0].outline.area_m2);
  EXPECT_NEAR(*walls[0].outline.area_m2, 4.0 * std::numbers::pi, 0.01);
  EXPECT_EQ(walls[0].lines.size(), walls[0].outline.radii_m.size());
  for (size_t i = 0; i < walls[0].lines.size(); ++i) {
    const SectionLine& next = walls[0].lines[(i + 1) % walls[0].lines.size()];
    EXPECT_LT((walls[0].lines[i].to - next.from).norm(), 1e-12);
  }
  EXPECT_EQ(walls[1].outline.coverage, 0.0) << "too far along the passage";
  EXPECT_TRUE(walls[1].lines.empty());
}

// Silt and fins give echoes before the wall.
TEST(EchoSections, FollowMostEchoesAndThoseNearThePlane) {
  std::vector<Vec3> echoes = ring(2.0, 0.1, 72 * 4), near = ring(0.4, 0.05, 72),
                    far = ring(3.0, 2.0, 72 * 20);
  echoes.insert(echoes.end(), near.begin(), near.end());
  echoes.insert(echoes.end(), far.begin(), far.end());
  const std::vector<StationWalls> walls = echoesAtStations(echoes, alongX(), {});
  EXPECT_NEAR(walls[0].size.left.value(), 2.0, 0.05);
  EXPECT_NEAR(walls[0].size.up.value(), 2.0, 0.05);
}

TEST(EchoSections, LeaveAWideGapOpen) {
  std::vector<Vec3> half = ring(2.0, 0.0, 720);
  std::erase_if(half, [](const Vec3& echo) { return echo.y() < 0.0; });
  Survey survey = alongX();
  survey.stations[0].passage.right = 7.0;
  const std::vector<StationWalls> walls = echoesAtStations(half, survey, {});
  EXPECT_FALSE(walls[0].outline.area_m2);
  EXPECT_FALSE(walls[0].size.right);
  EXPECT_NEAR(walls[0].size.left.value(), 2.0, 0.02);
  const Vec3 seen_before(0.0, 1.9, 0.1), not_seen(0.0, -7.0, 0.1);
  survey.stations[0].splays_ENU = {seen_before, not_seen};
  takeSections(walls, 16, &survey);
  EXPECT_EQ(survey.stations[0].splays_ENU.size(), 9u) << "eight of the sonar, and one where it saw nothing";
  EXPECT_EQ(survey.stations[0].splays_ENU.front(), not_seen);
  Survey without_splays = alongX();
  takeSections(walls, 0, &without_splays);
  EXPECT_TRUE(without_splays.stations[0].splays_ENU.empty());
  EXPECT_EQ(survey.stations[0].passage.right, 7.0) << "what is not known stays";
  EXPECT_NEAR(survey.stations[0].passage.left.value(), 2.0, 0.02);
}

}  // namespace
}  // namespace lodeline
