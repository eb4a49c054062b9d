#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <sstream>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/output/survey/formats/map_files.h"
#include "lodeline/output/survey/formats/point_normals.h"
#include "lodeline/output/survey/formats/test_map_images.h"
#include "lodeline/output/survey/formats/test_outside_program.h"
#include "lodeline/output/survey/formats/write_formats.h"
#include "lodeline/output/survey/map/test_dive.h"
#include "lodeline/trajectory.h"

// PLY, CSV, TUM, COLMAP.

namespace lodeline {
namespace {

using ::testing::HasSubstr;

using test::twoCameras;
using test::windingMap;

TEST(Ply, HoldsWayAndWallsWithNormalsInward) {
  const DiveMap map = windingMap();
  const std::string bytes = plyBytes(map);
  const size_t header = bytes.find("end_header\n") + 11;
  const size_t vertices = map.trajectory.size() + map.landmarks.size();
  constexpr size_t kVertexBytes = 6 * 4 + 3 + 4;
  ASSERT_EQ(bytes.size() - header, vertices * kVertexBytes + (map.trajectory.size() - 1) * 8);
  size_t inward = 0;
  for (size_t i = 0; i < map.landmarks.size(); ++i) {
    float values[6];
    std::memcpy(values, bytes.data() + header + (map.trajectory.size() + i) * kVertexBytes, sizeof(values));
    const Vec3 position(values[0], values[1], values[2]), normal(values[3], values[4], values[5]);
    EXPECT_NEAR(normal.norm(), 1.0, 1e-5);
    Vec3 nearest = map.trajectory.poses.front().world_from_body.translation;
    for (const StampedPose& pose : map.trajectory.poses) {
      const Vec3& p = pose.world_from_body.translation;
      if ((p - position).norm() < (nearest - position).norm()) nearest = p;
    }
    if (normal.dot((nearest - position).normalized()) > 0.9) ++inward;
  }
  EXPECT_GT(inward, map.landmarks.size() * 9 / 10);
}

TEST(PointNormals, OfFewOrEqualPointsPointAtTheView) {
  const std::vector<Vec3> views = {Vec3::Zero()};
  EXPECT_LT((normalsTowards({Vec3(2, 0, 0)}, views)[0] + Vec3::UnitX()).norm(), 1e-12);
  for (const Vec3& normal : normalsTowards(std::vector<Vec3>(20, Vec3(0, 0, 3)), views)) {
    EXPECT_LT((normal + Vec3::UnitZ()).norm(), 1e-12);
  }
  EXPECT_TRUE(normalsTowards({}, views).empty());
}

TEST(TumAndColmap, GiveTheSamePosesBack) {
  const test::TemporaryFolder folder;
  const DiveMap map = windingMap();
  const MapImages images = twoCameras(map);
  writeMap(map, images, MapFormat::Tum, folder.path());
  writeMap(map, images, MapFormat::Colmap, folder.path());
  Diagnostics diagnostics;
  const Trajectory tum = readTrajectory(folder.path() / "winding.tum", {}, diagnostics);
  ASSERT_EQ(tum.size(), map.trajectory.size());
  EXPECT_EQ(tum.poses[7].time, map.trajectory.poses[7].time);
  EXPECT_LT(
      (tum.poses[7].world_from_body.translation - map.trajectory.poses[7].world_from_body.translation).norm(),
      1e-8);
  TrajectoryReadOptions options;
  options.body_from_camera = images.cameras[0].body_from_camera;
  const Trajectory colmap = readTrajectory(folder.path() / "colmap", options, diagnostics);
  ASSERT_EQ(colmap.size(), images.images.size() / 2);
  for (size_t i = 0; i < colmap.size(); ++i) {
    const Rigid3& expected = map.trajectory.poses[10 * i].world_from_body;
    EXPECT_EQ(colmap.poses[i].time, map.trajectory.poses[10 * i].time);
    EXPECT_LT((colmap.poses[i].world_from_body.translation - expected.translation).norm(), 1e-6);
    EXPECT_LT(colmap.poses[i].world_from_body.rotation.angularDistance(expected.rotation), 1e-6);
  }
}

TEST(Colmap, HasAModelForEveryCamera) {
  const DiveMap map = windingMap();
  MapImages images = twoCameras(map);
  images.cameras[0].model = "field-of-view";
  images.cameras[0].distortion = {0.9};
  images.cameras[1].model = "double-sphere";
  images.cameras[1].distortion = {-0.2, 0.6};
  images.cameras[1].name = "cam1";
  const std::string cameras = colmapModel(map, images.cameras, images.images).cameras;
  EXPECT_THAT(cameras, HasSubstr("\n1 FOV 800 600 400 400 400 300 0.9\n"));
  EXPECT_THAT(cameras,
              HasSubstr("# cam1: COLMAP has no double-sphere model; the fisheye model below deviates by"));
  EXPECT_THAT(cameras, HasSubstr("\n2 OPENCV_FISHEYE 800 600 "));
}

TEST(Colmap, HasACameraOfLikeRaysForOneBehindAPort) {
  const DiveMap map = windingMap();
  MapImages images = twoCameras(map);
  images.cameras[0].name = "cam0";
  images.cameras[0].port = Port{.distance_m = 0.02, .thickness_m = 0.01};
  const std::string cameras = colmapModel(map, images.cameras, images.images).cameras;
  EXPECT_THAT(cameras, HasSubstr("# cam0: COLMAP has no radial-tangential model behind a port; the fisheye"));
  EXPECT_THAT(cameras, HasSubstr("\n1 OPENCV_FISHEYE 800 600 5")) << "water magnifies by a third";
}

TEST(Colmap, TakesTheModel) {
  LODELINE_NEEDS_PROGRAM("colmap", "colmap");
  const test::TemporaryFolder folder;
  const DiveMap map = windingMap();
  const MapImages images = twoCameras(map);
  writeMap(map, images, MapFormat::Colmap, folder.path());
  const test::OutsideRun run =
      test::runIn(folder.path(), "QT_QPA_PLATFORM=offscreen colmap model_analyzer --path colmap");
  EXPECT_EQ(run.exit_code, 0) << run.output;
  EXPECT_THAT(run.output, HasSubstr("Registered images: " + std::to_string(images.images.size())));
  EXPECT_THAT(run.output, HasSubstr("Points: " + std::to_string(map.landmarks.size())));
}

TEST(Colmap, NeedsTheRecordingsCameras) {
  EXPECT_THROW(writeMap(windingMap(), std::nullopt, MapFormat::Colmap, "/nowhere"), UsageError);
}

TEST(Csv, HasAsManyFieldsAsItsHeader) {
  const auto expectEvenRows = [](const std::string& text) {
    size_t columns = 0, rows = 0;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) {
      if (line.starts_with("#")) continue;
      const auto commas = static_cast<size_t>(std::count(line.begin(), line.end(), ','));
      if (rows++ == 0) columns = commas;
      EXPECT_EQ(commas, columns) << line;
    }
    EXPECT_GT(rows, 3U);
  };
  expectEvenRows(posesCsv(windingMap()));
  expectEvenRows(stationsCsv(windingMap()));
  Diagnostics diagnostics;
  RunFolder run = test::windingDive(30.0);
  run.uncertainties.clear();
  run.landmarks.clear();
  const DiveMap bare = makeDiveMap(run, {}, {}, &diagnostics);
  expectEvenRows(posesCsv(bare));
  expectEvenRows(stationsCsv(bare));
  EXPECT_EQ(diagnostics.count("sigma_assumed"), 1);
}

TEST(MapFormats, AreKnownByTheirNames) {
  EXPECT_EQ(mapFormatFromString("colmap"), MapFormat::Colmap);
  EXPECT_EQ(mapFormatFromString("survex"), MapFormat::Survex);
  EXPECT_THROW(mapFormatFromString("dwg"), UsageError);
}

}  // namespace
}  // namespace lodeline
