#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <set>
#include <string>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/output/walls/fusion/surface_blocks.h"
#include "lodeline/output/walls/fusion/test_sphere.h"
#include "lodeline/util/files/output_file.h"

namespace lodeline {
namespace {

const Tile kWhole = {Eigen::Vector3i::Constant(-20), Eigen::Vector3i::Constant(20)};

class TileFusion : public testing::Test {
 protected:
  void SetUp() override {
    if (!hasOpen3d()) GTEST_SKIP() << "built without Open3D";
    options_.voxel_m = 0.05;
  }
  WallMesh fuse(const Tile& tile = kWhole) const { return fuseTile(tile, input_, options_).value(); }

  DepthKeyframes input_ = test::sphereViews();
  FusionOptions options_;
};

TEST_F(TileFusion, FindsTheSurface) {
  const WallMesh mesh = fuse();
  ASSERT_GT(mesh.vertices(), 10'000U);
  size_t inwards = 0;
  for (size_t i = 0; i < mesh.vertices(); ++i) {
    EXPECT_NEAR(mesh.positions[i].norm(), test::kSphere_m, 0.025);
    inwards += mesh.normals[i].dot(mesh.positions[i]) < 0.0F ? 1 : 0;
    EXPECT_GE(mesh.views[i], options_.min_views);
    EXPECT_EQ(mesh.colours[i], (std::array<uint8_t, 3>{90, 60, 30}));
  }
  EXPECT_EQ(inwards, mesh.vertices());
  // Nearly the whole sphere: 4 pi r^2 over the area of the triangles.
  double area_m2 = 0.0;
  for (const auto& [a, b, c] : mesh.triangles) {
    const WallMesh::Point first = mesh.positions[b] - mesh.positions[a];
    area_m2 += 0.5 * first.cross(mesh.positions[c] - mesh.positions[a]).norm();
  }
  EXPECT_NEAR(area_m2, 4.0 * M_PI * test::kSphere_m * test::kSphere_m, 2.0);
}

TEST_F(TileFusion, GivesTheSameBytesAgain) {
  const test::TemporaryFolder folder;
  for (const char* name : {"a", "b"}) writeTileFile(fuse(), folder.path() / name);
  std::array<std::string, 2> bytes;
  for (size_t i = 0; i < 2; ++i) {
    std::ifstream stream(folder.path() / (i == 0 ? "a" : "b"), std::ios::binary);
    bytes[i].assign(std::istreambuf_iterator<char>(stream), {});
  }
  EXPECT_TRUE(bytes[0] == bytes[1]);
}

TEST_F(TileFusion, JoinsTilesWithoutASeam) {
  const WallMesh whole = fuse();
  size_t triangles = 0;
  std::set<std::array<float, 3>> vertices;
  for (const int low : {-20, 0}) {
    Tile half = kWhole;
    half.low.x() = low;
    half.high.x() = low + 20;
    const WallMesh mesh = fuse(half);
    triangles += mesh.triangles.size();
    for (const WallMesh::Point& p : mesh.positions) vertices.insert({p.x(), p.y(), p.z()});
  }
  EXPECT_EQ(triangles, whole.triangles.size());
  EXPECT_EQ(vertices.size(), whole.vertices());
}

TEST_F(TileFusion, LeavesOutParticles) {
  const auto clean = input_.depths;
  // A particle 30 cm before the camera, in one keyframe of the places of ten others.
  input_.depths = [clean](size_t number) {
    DepthImage image = clean(number);
    if (number % 7 != 0) return image;
    for (int v = 25; v < 40; ++v) {
      for (int u = 25; u < 40; ++u) image.set(u, v, 0.7, 0.01);
    }
    return image;
  };
  for (const WallMesh::Point& point : fuse().positions) EXPECT_NEAR(point.norm(), test::kSphere_m, 0.08);
}

TEST_F(TileFusion, AsksForSmallerTiles) {
  options_.max_blocks = 50;
  EXPECT_FALSE(fuseTile(kWhole, input_, options_));
  options_.max_blocks = 100'000;
  EXPECT_TRUE(fuseTile(kWhole, input_, options_));
}

TEST_F(TileFusion, NeedsSeveralViews) {
  input_.keyframes.resize(2);
  EXPECT_TRUE(fuse().empty());
  EXPECT_TRUE(surfaceBlocks(kWhole, input_, options_).value().empty());
  options_.min_views = 1;
  EXPECT_FALSE(fuse().empty());
}

TEST_F(TileFusion, LeavesOutWhatAllViewsTogetherDoNotKnow) {
  const auto clean = input_.depths;
  double sigma_m = 0.05;
  input_.depths = [&](size_t number) {
    DepthImage image = clean(number);
    image.sigma.setTo(1e3 * sigma_m);
    return image;
  };
  // Of 60 views, some fifteen show a voxel: 5 cm become 1.3 cm, and 25 cm become 6.5 cm.
  const size_t whole = fuse().vertices();
  EXPECT_GT(whole, 10'000U);
  sigma_m = 0.25;
  EXPECT_LT(fuse().vertices(), whole / 4);
}

TEST(TileFile, RefusesDamage) {
  const test::TemporaryFolder folder;
  WallMesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.colours.resize(3);
  mesh.views = {3, 4, 5};
  mesh.triangles = {{0, 1, 2}};
  mesh.computeNormals();
  const std::filesystem::path file = folder.path() / "tile";
  writeTileFile(mesh, file);
  EXPECT_EQ(readTileFile(file).views, mesh.views);
  EXPECT_EQ(readTileFile(file).normals[1], WallMesh::Point::UnitZ());
  std::filesystem::resize_file(file, 40);
  EXPECT_THROW(readTileFile(file), InputError);
  EXPECT_THROW(readTileFile(folder.path() / "none"), InputError);
}

TEST(WallVolumeModule, IsNoPartOfPrograms) {
  const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
  FILE* libraries = ::popen(("ldd '" + program + "'").c_str(), "r");
  ASSERT_NE(libraries, nullptr);
  std::string text;
  for (int c = std::fgetc(libraries); c != EOF; c = std::fgetc(libraries)) text += static_cast<char>(c);
  ASSERT_EQ(::pclose(libraries), 0);
  EXPECT_NE(text.find("libopencv_core"), std::string::npos);
  EXPECT_EQ(text.find("Open3D"), std::string::npos);
}

}  // namespace
}  // namespace lodeline
