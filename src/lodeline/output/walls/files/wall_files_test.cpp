#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/output/survey/formats/gis/dxf_drawing.h"
#include "lodeline/output/survey/map/test_dive.h"
#include "lodeline/output/walls/files/wall_tiles.h"
#include "lodeline/output/walls/files/write_las.h"

namespace lodeline {
namespace {

using ::testing::HasSubstr;

class WallFiles : public testing::Test {
 protected:
  void SetUp() override {
    for (const float x : {0.0F, 10.0F}) {
      WallMesh mesh;
      mesh.positions = {
          {x, 0.25F, -1.5F}, {x + 1.0F, 0.0F, -1.0F}, {x, 1.0F, -2.0F}, {x + 1.0F, 1.0F, -2.0F}};
      mesh.colours = {{255, 0, 10}, {1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
      mesh.views = {3, 400, 5, 6};
      mesh.triangles = {{0, 1, 2}, {1, 3, 2}};
      mesh.computeNormals();
      const std::filesystem::path file = folder_.path() / ("tile" + std::to_string(static_cast<int>(x)));
      writeTileFile(mesh, file);
      tiles_.add(file, mesh);
    }
    tiles_.add("empty", WallMesh());
  }

  std::string bytes(const char* name) const {
    std::ifstream stream(folder_.path() / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  template <typename Value>
  static Value at(const std::string& bytes, size_t offset) {
    Value value;
    std::memcpy(&value, bytes.data() + offset, sizeof(value));
    return value;
  }

  test::TemporaryFolder folder_;
  WallTiles tiles_;
};

TEST_F(WallFiles, PlyHoldsAllTiles) {
  writeWallsPly(tiles_, {"a note"}, true, folder_.path() / "mesh.ply");
  const std::string text = bytes("mesh.ply");
  EXPECT_THAT(text, HasSubstr("comment a note\nelement vertex 8\n"));
  EXPECT_THAT(text, HasSubstr("element face 4\n"));
  const size_t body = text.find("end_header\n") + 11;
  ASSERT_EQ(text.size(), body + 8 * 31 + 4 * 13);
  EXPECT_EQ(at<float>(text, body + 4 * 31), 10.0F);
  EXPECT_EQ(at<int32_t>(text, body + 31 + 27), 400);
  // The first triangle of the second tile counts on from the vertices of the first.
  EXPECT_EQ(at<uint32_t>(text, body + 8 * 31 + 2 * 13 + 1), 4U);
  writeWallsPly(tiles_, {}, false, folder_.path() / "cloud.ply");
  EXPECT_THAT(bytes("cloud.ply"), Not(HasSubstr("face")));
}

TEST_F(WallFiles, GlbIsWhole) {
  writeWallsGlb(tiles_, {"a note"}, folder_.path() / "mesh.glb");
  const std::string file = bytes("mesh.glb");
  EXPECT_EQ(file.substr(0, 4), "glTF");
  EXPECT_EQ(at<uint32_t>(file, 4), 2U);
  ASSERT_EQ(at<uint32_t>(file, 8), file.size());
  const auto json_bytes = at<uint32_t>(file, 12);
  EXPECT_EQ(json_bytes % 4, 0U);
  const auto json = nlohmann::json::parse(file.substr(20, json_bytes));
  const size_t binary = 20 + json_bytes + 8;
  EXPECT_EQ(at<uint32_t>(file, binary - 8), file.size() - binary);
  EXPECT_EQ(json["buffers"][0]["byteLength"], file.size() - binary);
  const auto& primitives = json["meshes"][0]["primitives"];
  ASSERT_EQ(primitives.size(), 2U);
  // Every view lies in the buffer, and every index in its vertices.
  for (const auto& view : json["bufferViews"])
    EXPECT_LE(view["byteOffset"].get<size_t>() + view["byteLength"].get<size_t>(), file.size() - binary);
  for (const auto& primitive : primitives) {
    const auto& indices = json["accessors"][primitive["indices"].get<size_t>()];
    const auto& positions = json["accessors"][primitive["attributes"]["POSITION"].get<size_t>()];
    const size_t first = json["bufferViews"][indices["bufferView"].get<size_t>()]["byteOffset"];
    for (size_t i = 0; i < indices["count"].get<size_t>(); ++i)
      EXPECT_LT(at<uint32_t>(file, binary + first + 4 * i), positions["count"].get<uint32_t>());
  }
  EXPECT_EQ(json["accessors"][primitives[1]["attributes"]["POSITION"].get<size_t>()]["min"][0], 10.0);
}

TEST_F(WallFiles, LasHoldsPointsOfAMapWithoutPlace) {
  Diagnostics diagnostics;
  DiveMapOptions options;
  options.start_depth_m = 5.0;
  const DiveMap map = makeDiveMap(test::windingDive(), options, {}, &diagnostics);
  writeLas(tiles_, map, folder_.path() / "cloud.las");
  const std::string file = bytes("cloud.las");
  EXPECT_EQ(file.substr(0, 4), "LASF");
  EXPECT_EQ(file.substr(24, 2), std::string("\x01\x04", 2));
  EXPECT_EQ(at<uint16_t>(file, 94), 375);
  EXPECT_EQ(at<uint32_t>(file, 96), 375U);
  EXPECT_EQ(at<uint32_t>(file, 100), 0U);
  EXPECT_EQ(at<uint8_t>(file, 104), 7);
  EXPECT_EQ(at<uint16_t>(file, 105), 36);
  EXPECT_EQ(at<uint64_t>(file, 247), 8U);
  ASSERT_EQ(file.size(), 375U + 8 * 36);
  for (const size_t point : {size_t{0}, size_t{4}}) {
    const size_t start = 375 + 36 * point;
    for (size_t axis = 0; axis < 3; ++axis) {
      const double value = at<int32_t>(file, start + 4 * axis) * at<double>(file, 131 + 8 * axis) +
                           at<double>(file, 155 + 8 * axis);
      const Vec3 expected = drawingPoint(map, Vec3(point == 0 ? 0.0 : 10.0, 0.25, -1.5));
      EXPECT_NEAR(value, expected[static_cast<Eigen::Index>(axis)], 0.0006);
      EXPECT_LE(value, at<double>(file, 179 + 16 * axis) + 0.001);
      EXPECT_GE(value, at<double>(file, 187 + 16 * axis) - 0.001);
    }
    EXPECT_EQ(at<uint16_t>(file, start + 30), 65535);
    EXPECT_EQ(at<uint16_t>(file, start + 34), 2570);
  }
  EXPECT_EQ(at<uint8_t>(file, 375 + 36 + 17), 255) << "views, at most 255";
}

TEST_F(WallFiles, LasNamesItsGrid) {
  Diagnostics diagnostics;
  DiveMapOptions options;
  options.entrance = test::kDevilsEye;
  const DiveMap map = makeDiveMap(test::windingDive(), options, {}, &diagnostics);
  writeLas(tiles_, map, folder_.path() / "cloud.las");
  const std::string file = bytes("cloud.las");
  EXPECT_EQ(at<uint32_t>(file, 100), 1U);
  EXPECT_EQ(std::string(file.data() + 377), "LASF_Projection");
  EXPECT_EQ(at<uint16_t>(file, 393), 2112);
  EXPECT_THAT(std::string(file.data() + 375 + 54), HasSubstr("UTM zone 17N"));
  EXPECT_EQ(at<uint16_t>(file, 395), at<uint32_t>(file, 96) - 375 - 54);
  const double east = at<int32_t>(file, at<uint32_t>(file, 96)) * 0.001 + at<double>(file, 155);
  EXPECT_NEAR(east, map.place->grid(Vec3(0.0, 0.25, -1.5)).x(), 0.001);
}

}  // namespace
}  // namespace lodeline
