#include "lodeline/output/colmap/colmap_database.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/mapping/store/sqlite/database.h"
#include "lodeline/output/survey/formats/test_map_images.h"
#include "lodeline/output/survey/formats/test_outside_program.h"

namespace lodeline {
namespace {

using test::twoCameras;
using test::windingMap;
using ::testing::HasSubstr;

std::vector<double> numbersOf(std::span<const unsigned char> blob) {
  std::vector<double> numbers(blob.size() / sizeof(double));
  std::memcpy(numbers.data(), blob.data(), blob.size());
  return numbers;
}

class ColmapDatabase : public ::testing::Test {
 protected:
  void write(const MapImages& images) {
    writeColmapDatabase(map_, images, file_, &diagnostics_);
    database_ = std::make_unique<Database>(file_, Database::Mode::Read);
  }

  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "colmap/database.db";
  DiveMap map_ = windingMap();
  Diagnostics diagnostics_;
  std::unique_ptr<Database> database_;
};

TEST_F(ColmapDatabase, HasTheCamerasWithTheNumbersOfTheirModels) {
  const MapImages images = twoCameras(map_);
  write(images);
  Query cameras = database_->query("SELECT model, width, height, params FROM cameras ORDER BY camera_id");
  ASSERT_TRUE(cameras.next());
  EXPECT_EQ(cameras.integerAt(0), 4) << "OPENCV";
  EXPECT_EQ(cameras.integerAt(1), 800);
  EXPECT_EQ(cameras.integerAt(2), 600);
  EXPECT_THAT(numbersOf(cameras.blobAt(3)),
              ::testing::ElementsAre(400.0, 400.0, 400.0, 300.0, -0.1, 0.01, 0.001, 0.002));
  ASSERT_TRUE(cameras.next());
  EXPECT_EQ(cameras.integerAt(0), 5) << "OPENCV_FISHEYE";
  EXPECT_FALSE(cameras.next());
  EXPECT_TRUE(diagnostics_.ranked().empty());
}

TEST_F(ColmapDatabase, HasPriorsThatGiveThePosesBack) {
  const MapImages images = twoCameras(map_);
  write(images);
  EXPECT_EQ(database_->number("SELECT count(*) FROM images"), static_cast<int64_t>(images.images.size()));
  Query rows = database_->query(
      "SELECT prior_qw, prior_qx, prior_qy, prior_qz, prior_tx, prior_ty, prior_tz, name, camera_id, "
      "position, "
      "position_covariance, coordinate_system FROM images JOIN pose_priors USING (image_id) ORDER BY "
      "image_id");
  for (const ColmapImage& image : images.images) {
    ASSERT_TRUE(rows.next());
    const Quat camera_from_map(rows.realAt(0), rows.realAt(1), rows.realAt(2), rows.realAt(3));
    const Vec3 centre(rows.realAt(4), rows.realAt(5), rows.realAt(6));
    const Rigid3 expected =
        map_.trajectory.poses[image.pose].world_from_body * images.cameras[image.camera].body_from_camera;
    EXPECT_LT(camera_from_map.angularDistance(expected.rotation.conjugate()), 1e-9);
    EXPECT_LT((centre - expected.translation).norm(), 1e-9);
    EXPECT_EQ(rows.textAt(7), image.name);
    EXPECT_EQ(rows.integerAt(8), static_cast<int64_t>(image.camera + 1));
    EXPECT_EQ(numbersOf(rows.blobAt(9)), std::vector<double>(centre.data(), centre.data() + 3));
    const Mat3& covariance = map_.uncertainties.at(image.pose).covariance;
    EXPECT_EQ(numbersOf(rows.blobAt(10)), std::vector<double>(covariance.data(), covariance.data() + 9));
    EXPECT_EQ(rows.integerAt(11), 1) << "metres, not degrees";
  }
}

TEST_F(ColmapDatabase, LeavesOutCovariancesThatTheRunLacks) {
  map_.uncertainties.clear();
  write(twoCameras(map_));
  EXPECT_EQ(database_->number("SELECT count(*) FROM pose_priors WHERE position_covariance IS NOT NULL"), 0);
}

TEST_F(ColmapDatabase, SaysWhichCameraIsFitted) {
  MapImages images = twoCameras(map_);
  images.cameras[1].name = "cam1";
  images.cameras[1].model = "double-sphere";
  images.cameras[1].distortion = {-0.2, 0.6};
  write(images);
  ASSERT_EQ(diagnostics_.count("colmap_camera_fitted"), 1);
  EXPECT_THAT(diagnostics_.ranked().front().first_message,
              HasSubstr("cam1: COLMAP has no double-sphere model"));
  EXPECT_EQ(database_->number("SELECT model FROM cameras WHERE camera_id = 2"), 5);
}

TEST_F(ColmapDatabase, ReplacesAnEarlierOne) {
  std::filesystem::create_directories(file_.parent_path());
  std::ofstream(file_) << "no database";
  write(twoCameras(map_));
  EXPECT_GT(database_->number("SELECT count(*) FROM images"), 0);
}

TEST_F(ColmapDatabase, NeedsImages) {
  EXPECT_THROW(writeColmapDatabase(map_, std::nullopt, file_, &diagnostics_), UsageError);
  EXPECT_THROW(writeColmapDatabase(map_, MapImages{twoCameras(map_).cameras, {}}, file_, &diagnostics_),
               UsageError);
}

TEST_F(ColmapDatabase, HasTheTablesOfColmap) {
  LODELINE_NEEDS_PROGRAM("colmap", "colmap");
  write(twoCameras(map_));
  const test::OutsideRun made = test::runIn(
      folder_.path(), "QT_QPA_PLATFORM=offscreen colmap database_creator --database_path theirs.db");
  ASSERT_EQ(made.exit_code, 0) << made.output;
  Database theirs(folder_.path() / "theirs.db", Database::Mode::Read);
  for (Query tables = theirs.query("SELECT name FROM sqlite_master WHERE type = 'table'"); tables.next();) {
    const auto columnsOf = [&](Database* database) {
      std::string columns;
      Query query = database->query("SELECT name, type FROM pragma_table_info(?) ORDER BY cid");
      for (query.text(tables.textAt(0)); query.next();)
        columns += query.textAt(0) + " " + query.textAt(1) + "\n";
      return columns;
    };
    EXPECT_EQ(columnsOf(database_.get()), columnsOf(&theirs)) << tables.textAt(0);
  }
}

}  // namespace
}  // namespace lodeline
