#include "lodeline/output/walls/section/cross_section.h"

#include <gtest/gtest.h>

#include <numbers>

#include "lodeline/output/walls/section/wall_sections.h"

namespace lodeline {
namespace {

/// A tube along x with an elliptic section, open where `isOpen` says so of an angle from the left.
template <typename IsOpen>
WallMesh tube(double half_width_m, double half_height_m, const IsOpen& isOpen) {
  constexpr uint32_t kSides = 360;
  WallMesh mesh;
  for (const float x : {-1.03F, 1.07F}) {
    for (uint32_t i = 0; i < kSides; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / kSides;
      mesh.positions.emplace_back(x, half_width_m * std::cos(angle), half_height_m * std::sin(angle));
    }
  }
  for (uint32_t i = 0; i < kSides; ++i) {
    const uint32_t next = (i + 1) % kSides;
    if (isOpen(2.0 * std::numbers::pi * i / kSides)) continue;
    mesh.triangles.push_back({i, next, kSides + i});
    mesh.triangles.push_back({next, kSides + next, kSides + i});
  }
  return mesh;
}

const auto closed = [](double) { return false; };

SectionOutline outlineAt(const WallMesh& mesh, const Vec3& origin) {
  const SectionPlane plane = planeAcross({origin, Vec3::UnitX(), Vec3::UnitY()});
  std::vector<SectionLine> lines;
  cutMesh(mesh, plane, 10.0, &lines);
  return outlineOf(lines, {});
}

TEST(CrossSection, MeasuresAnEllipse) {
  const SectionOutline outline = outlineAt(tube(2.0, 1.2, closed), Vec3::Zero());
  EXPECT_EQ(outline.coverage, 1.0);
  EXPECT_NEAR(outline.area_m2.value(), std::numbers::pi * 2.0 * 1.2, 0.02);
  EXPECT_NEAR(outline.towards(0.0).value(), 2.0, 0.04);
  EXPECT_NEAR(outline.towards(0.5 * std::numbers::pi).value(), 1.2, 0.02);
}

TEST(CrossSection, KnowsRightFromLeft) {
  const SectionOutline outline = outlineAt(tube(2.0, 1.2, closed), Vec3(0.0, 0.5, -0.2));
  EXPECT_NEAR(outline.towards(0.0).value(), 2.5, 0.05) << "right: y is to the left";
  EXPECT_NEAR(outline.towards(std::numbers::pi).value(), 1.5, 0.05);
  EXPECT_NEAR(outline.towards(0.5 * std::numbers::pi).value(), 1.4, 0.05);
  EXPECT_NEAR(outline.towards(-0.5 * std::numbers::pi).value(), 1.0, 0.05);
  EXPECT_NEAR(outline.area_m2.value(), std::numbers::pi * 2.0 * 1.2, 0.1);
}

TEST(CrossSection, OfAnOpenPassageHasTheAreaThatWasSeen) {
  const auto isAbove = [](double angle) { return angle < std::numbers::pi; };
  const SectionOutline whole = outlineAt(tube(2.0, 2.0, closed), Vec3::Zero());
  EXPECT_NEAR(whole.seen_area_m2, whole.area_m2.value(), 1e-9);
  const SectionOutline half = outlineAt(tube(2.0, 2.0, isAbove), Vec3::Zero());
  EXPECT_FALSE(half.area_m2);
  EXPECT_NEAR(half.seen_area_m2, 2.0 * std::numbers::pi, 0.2);
  EXPECT_EQ(outlineOf(std::vector<SectionLine>(), {}).seen_area_m2, 0.0);
}

TEST(CrossSection, OnTheSheetTellsWhatWasSeenInAScaleForMost) {
  const auto wallsOf = [](double radius_m, const auto& is_open) {
    StationWalls walls;
    walls.across = planeAcross({Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()});
    cutMesh(tube(radius_m, radius_m, is_open), walls.across, 30.0, &walls.lines);
    walls.outline = outlineOf(walls.lines, {});
    return walls;
  };
  const auto isAbove = [](double angle) { return angle < std::numbers::pi; };
  const auto isNearlyAll = [](double angle) { return angle > 0.2; };
  DiveMap map;
  map.title = "dive <1>";
  const std::string sheet = sectionsSvg(
      map, {wallsOf(2.0, closed), wallsOf(2.0, isAbove), StationWalls(), wallsOf(20.0, isNearlyAll)});
  EXPECT_NE(sheet.find("dive &lt;1&gt;"), std::string::npos);
  EXPECT_NE(sheet.find(">0: 12.6 m², walls in 100 %<"), std::string::npos) << sheet;
  EXPECT_NE(sheet.find(">1: open, 6."), std::string::npos) << sheet;
  EXPECT_NE(sheet.find(">2: no walls seen<"), std::string::npos);
  // A wall at 20 m in one direction does not set the scale: 2 m fill most of a panel.
  EXPECT_NE(sheet.find(">1 m<"), std::string::npos) << sheet;
  EXPECT_EQ(sheet.find("nan"), std::string::npos);
}

TEST(CrossSection, FillsASmallGapOnly) {
  const auto gap = [](double width_rad) { return [=](double angle) { return angle < width_rad; }; };
  const SectionOutline small = outlineAt(tube(2.0, 2.0, gap(0.4)), Vec3::Zero());
  EXPECT_NEAR(small.area_m2.value(), 4.0 * std::numbers::pi, 0.05);
  EXPECT_LT(small.coverage, 0.96);
  const SectionOutline large = outlineAt(tube(2.0, 2.0, gap(0.8)), Vec3::Zero());
  EXPECT_FALSE(large.area_m2);
  EXPECT_FALSE(outlineAt(tube(2.0, 2.0, gap(7.0)), Vec3::Zero()).towards(1.0));
}

TEST(CrossSection, IsSoughtInItsPlaneAndReach) {
  const WallMesh mesh = tube(2.0, 1.2, closed);
  EXPECT_EQ(outlineAt(mesh, Vec3(1.5, 0.0, 0.0)).coverage, 0.0);
  std::vector<SectionLine> lines;
  cutMesh(mesh, planeAcross({Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()}), 1.0, &lines);
  EXPECT_TRUE(lines.empty());
}

TEST(CrossSection, CountsTheNearestWall) {
  WallMesh mesh = tube(2.0, 2.0, closed);
  const WallMesh far = tube(3.0, 3.0, closed);
  const auto first = static_cast<uint32_t>(mesh.vertices());
  mesh.positions.insert(mesh.positions.end(), far.positions.begin(), far.positions.end());
  for (const auto& [a, b, c] : far.triangles) mesh.triangles.push_back({first + a, first + b, first + c});
  EXPECT_NEAR(outlineAt(mesh, Vec3::Zero()).area_m2.value(), 4.0 * std::numbers::pi, 0.05);
}

TEST(CrossSection, VerticalPlaneIsUprightOnASlope) {
  const Vec3 along = Vec3(1.0, 0.0, -1.0).normalized();
  const SectionPlane plane = verticalPlane({Vec3(1, 2, 3), along, Vec3::UnitY()});
  EXPECT_EQ(plane.above, Vec3::UnitZ());
  EXPECT_NEAR((plane.right + Vec3::UnitY()).norm(), 0.0, 1e-12);
  EXPECT_NEAR(planeAcross({Vec3(1, 2, 3), along, Vec3::UnitY()}).normal().dot(along), 1.0, 1e-9);
}

}  // namespace
}  // namespace lodeline
