#include "lodeline/output/report/data/wall_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <limits>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"

namespace lodeline {
namespace {

using test::TemporaryFolder;
using testing::HasSubstr;

class WallFile : public testing::Test {
 protected:
  std::filesystem::path file() const { return folder_.path() / "walls.ply"; }
  std::ofstream start(const std::string& header) {
    std::ofstream stream(file(), std::ios::binary);
    stream << "ply\nformat binary_little_endian 1.0\n" << header << "end_header\n";
    return stream;
  }
  template <typename Value>
  static void put(std::ofstream& stream, Value value) {
    stream.write(reinterpret_cast<const char*>(&value), sizeof(value));
  }
  std::string error() const {
    try {
      readWallFile(file());
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  }
  TemporaryFolder folder_;
};

TEST_F(WallFile, ReadsCoordinatesAndColoursAmongOtherProperties) {
  {
    auto stream = start(
        "comment m\nelement vertex 2\nproperty double x\nproperty float nx\nproperty double y\nproperty "
        "double z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n"
        "property list uchar int vertex_indices\n");
    for (const double x : {1.5, -2.0}) {
      put(stream, x);
      put(stream, 9.0f);
      put(stream, x + 1.0);
      put(stream, x + 2.0);
      for (const uint8_t c : {10, 20, 30}) put(stream, c);
    }
    stream << "what follows is of the faces";
  }
  const ColouredPoints points = readWallFile(file());
  ASSERT_EQ(points.positions.size(), 2u);
  EXPECT_EQ(points.positions[1], Eigen::Vector3f(-2.0f, -1.0f, 0.0f));
  EXPECT_EQ(points.colours[0], (std::array<uint8_t, 3>{10, 20, 30}));
}

TEST_F(WallFile, PassesOverPointsThatAreNotFinite) {
  {
    auto stream = start("element vertex 2\nproperty float x\nproperty float y\nproperty float z\n");
    for (const float v : {1.0f, 2.0f, 3.0f, std::numeric_limits<float>::quiet_NaN(), 0.0f, 0.0f})
      put(stream, v);
  }
  const ColouredPoints points = readWallFile(file());
  EXPECT_EQ(points.positions.size(), 1u);
  EXPECT_TRUE(points.colours.empty());
}

TEST_F(WallFile, NamesWhatIsWrong) {
  folder_.write("walls.ply", "solid\n");
  EXPECT_THAT(error(), HasSubstr("no PLY file"));
  folder_.write("walls.ply", "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nend_header\n");
  EXPECT_THAT(error(), HasSubstr("binary little-endian"));
  start("element vertex 1\nproperty int x\nproperty float y\nproperty float z\n");
  EXPECT_THAT(error(), HasSubstr("'x'"));
  start("element face 1\nproperty list uchar int i\nelement vertex 1\nproperty float x\n");
  EXPECT_THAT(error(), HasSubstr("first element"));
  start("element vertex 99999999999\nproperty float x\nproperty float y\nproperty float z\n");
  EXPECT_THAT(error(), HasSubstr("ends after 0"));
  folder_.write("walls.ply", "ply\nformat binary_little_endian 1.0\nelement vertex 1\n");
  EXPECT_THAT(error(), HasSubstr("no end"));
}

TEST(CloudJson, StepsReachBothEndsOfTheBox) {
  const ColouredPoints points{{{-1.0f, 2.0f, 0.0f}, {3.0f, 2.0f, 500.0f}}, {{1, 2, 3}, {4, 5, 6}}};
  const auto json = cloudJson(points, 100);
  EXPECT_EQ(json["total"], 2);
  EXPECT_NEAR(json["low_m"][0].get<double>() + 65535 * json["step_m"][0].get<double>(), 3.0, 1e-4);
  // 0, 0, 0, then 65535, 0, 65535; the height of all points is the same along y.
  EXPECT_EQ(json["xyz"], "AAAAAAAA//8AAP//");
  EXPECT_EQ(json["rgb"], "AQIDBAUG");
  EXPECT_EQ(cloudJson(points, 1)["total"], 2);
  EXPECT_EQ(cloudJson({}, 0)["xyz"], "");
}

}  // namespace
}  // namespace lodeline
