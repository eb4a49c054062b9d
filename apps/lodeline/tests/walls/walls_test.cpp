#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "apps/lodeline/tests/test_room.h"
#include "lodeline/output/walls/fusion/tile_fusion.h"

namespace lodeline::test {
namespace {

using ::testing::HasSubstr;

/// Half sizes of the room along x, y, z, m (test_recording.cpp).
constexpr std::array<double, 3> kRoom_m = {3.0, 2.2, 1.6};

/// Positions of a cloud that `lodeline walls` wrote.
std::vector<std::array<float, 3>> cloudOf(const std::filesystem::path& file) {
  constexpr size_t kVertexBytes = 31;
  const std::string text = readText(file);
  const size_t body = text.find("end_header\n") + 11;
  std::vector<std::array<float, 3>> points((text.size() - body) / kVertexBytes);
  for (size_t i = 0; i < points.size(); ++i)
    std::copy_n(text.data() + body + i * kVertexBytes, 12, reinterpret_cast<char*>(points[i].data()));
  return points;
}

/// Walls of the room with its true poses as the run.
class WallsTest : public RoomTest {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(output_);
    std::filesystem::copy_file(recording_.truth, output_ / "trajectory.tum");
    std::ofstream(output_ / "run.json")
        << R"({"program": "test", "heading": {"reference": "true north"}, "data": ")"
        << recording_.data.string() << "\"}";
    if (!hasOpen3d()) GTEST_SKIP() << "built without Open3D";
  }

  Execution walls(const std::string& options) const {
    return runProgram(
        fmt::format("walls {} -o {} --quiet --step 0.04 --voxel 0.04 --max-error 0.2 --spacing 0.5 {}",
                    quoted(output_), quoted(walls_), options));
  }

  /// Share of the cloud within 5 cm of a wall of the room.
  double shareOnWalls() const {
    const auto points = cloudOf(walls_ / "cloud.ply");
    int near = 0;
    for (const auto& point : points) {
      double distance_m = 1.0;
      for (size_t axis = 0; axis < 3; ++axis)
        distance_m = std::min(distance_m, std::abs(std::abs(point[axis]) - kRoom_m[axis]));
      near += distance_m < 0.05 ? 1 : 0;
    }
    return points.empty() ? 0.0 : static_cast<double>(near) / static_cast<double>(points.size());
  }

  std::filesystem::path walls_ = folder_.path() / "walls";
};

TEST_F(WallsTest, LieOnTheWallsOfTheRoom) {
  const Execution result = walls("");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const nlohmann::json summary = readJson(walls_ / "walls.json");
  EXPECT_GT(summary["points"], 2000);
  EXPECT_GT(shareOnWalls(), 0.9);
  for (const char* name : {"cloud.las", "mesh.ply", "mesh.glb", "sections.csv", "sections.svg"})
    EXPECT_TRUE(std::filesystem::file_size(walls_ / name) > 100) << name;
  EXPECT_FALSE(std::filesystem::exists(walls_ / "work"));
}

TEST_F(WallsTest, ComeFromOneCameraToo) {
  const Execution result = walls("--one-camera");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_GT(readJson(walls_ / "walls.json")["points"], 500);
  EXPECT_GT(shareOnWalls(), 0.7);
}

TEST_F(WallsTest, AreOfAPartOfTheRun) {
  ASSERT_EQ(walls("--from 0.4 --to 0.9").exit_code, 0);
  const nlohmann::json summary = readJson(walls_ / "walls.json");
  EXPECT_NEAR(summary["dive_s"].get<double>(), 0.5, 0.11);
  EXPECT_GT(summary["points"], 500);
  EXPECT_EQ(walls("--from 100").exit_code, 2);
}

TEST_F(WallsTest, GoOnFromUnfinishedWork) {
  ASSERT_EQ(walls("--keep-work").exit_code, 0);
  const std::string cloud = readText(walls_ / "cloud.ply");
  // As after an interruption: one depth image and one tile are missing, and files are half written.
  std::filesystem::remove(walls_ / "work" / "000002.depth");
  for (const auto& entry : std::filesystem::directory_iterator(walls_ / "work")) {
    if (entry.path().extension() != ".mesh") continue;
    std::filesystem::rename(entry.path(), entry.path().string() + ".part");
    break;
  }
  ASSERT_EQ(walls("").exit_code, 0);
  EXPECT_TRUE(readText(walls_ / "cloud.ply") == cloud) << "another cloud";
}

TEST_F(WallsTest, RefuseWrongInput) {
  const Execution no_run = runProgram("walls " + quoted(folder_.path() / "none"));
  EXPECT_EQ(no_run.exit_code, 1) << no_run.output;
  replaceText(output_ / "run.json", recording_.data.string(), "/nowhere");
  const Execution moved = walls("");
  EXPECT_EQ(moved.exit_code, 2) << moved.output;
  EXPECT_THAT(moved.output, HasSubstr("--recording"));
  EXPECT_EQ(walls("--recording " + quoted(recording_.data)).exit_code, 0);
  std::filesystem::rename(output_, folder_.path() / "other");
  output_ = folder_.path() / "other";
  const Execution other = walls("--recording " + quoted(recording_.data));
  EXPECT_EQ(other.exit_code, 2) << other.output;
  EXPECT_THAT(other.output, HasSubstr("--overwrite"));
}

TEST_F(WallsTest, SayThatNothingIsSeen) {
  for (int camera = 0; camera < 2; ++camera) {
    for (size_t i = 0; i < recording_.image_names.size(); ++i) writeBlankImage(recording_.image(camera, i));
  }
  const Execution result = walls("");
  EXPECT_EQ(result.exit_code, 3) << result.output;
  EXPECT_THAT(result.output, HasSubstr("none of"));
}

}  // namespace
}  // namespace lodeline::test
