#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <filesystem>
#include <fstream>
#include <opencv2/imgproc.hpp>

#include "lodeline/board/board_detector.h"
#include "lodeline/board/board_print.h"
#include "lodeline/board/tag_family.h"

namespace lodeline {
namespace {

using ::testing::HasSubstr;

class BoardFileTest : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(file_); }

  CalibrationBoard read(const std::string& text) {
    std::ofstream(file_) << text;
    return readBoard(file_);
  }
  void expectRefused(const std::string& text, const std::string& because) {
    try {
      read(text);
      FAIL() << text;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(because));
    }
  }

  const std::filesystem::path file_ =
      std::filesystem::temp_directory_path() /
      (std::string("lodeline_board_") + testing::UnitTest::GetInstance()->current_test_info()->name() +
       ".yaml");
};

TEST_F(BoardFileTest, ReadsWhatItWrites) {
  const CalibrationBoard board{.columns = 5, .rows = 7, .tag_size_m = 0.0301, .spacing = 0.25};
  const CalibrationBoard back = read(boardText(board));
  EXPECT_EQ(back.columns, 5);
  EXPECT_EQ(back.rows, 7);
  EXPECT_EQ(back.tag_size_m, 0.0301);
  EXPECT_EQ(back.spacing, 0.25);
}

TEST_F(BoardFileTest, RefusesOtherBoardsAndImpossibleValues) {
  expectRefused("target_type: checkerboard\n", "boards of AprilTags are supported");
  expectRefused("target_type: aprilgrid\ntagCols: 6\ntagRows: 6\ntagSize: 0.088\n", "tagSpacing");
  expectRefused("target_type: aprilgrid\ntagCols: 6.5\ntagRows: 6\ntagSize: 0.088\ntagSpacing: 0.3\n",
                "must be a number of tags");
  expectRefused("target_type: aprilgrid\ntagCols: 6\ntagRows: 6\ntagSize: 88\ntagSpacing: 0.3\n",
                "must be between");
  expectRefused("target_type: aprilgrid\ntagCols: 30\ntagRows: 30\ntagSize: 0.01\ntagSpacing: 0.3\n",
                "the family 36h11 has 587");
}

TEST(CalibrationBoard, HasItsOriginAtTheLowerLeftCornerOfTagZero) {
  const CalibrationBoard board{.columns = 6, .rows = 6, .tag_size_m = 0.1, .spacing = 0.3};
  EXPECT_EQ(board.corner_T(0), Vec3(0.0, 0.0, 0.0));
  EXPECT_LT((board.corner_T(2) - Vec3(0.1, 0.1, 0.0)).norm(), 1e-12);
  EXPECT_LT((board.corner_T(4 * 7 + 1) - Vec3(0.23, 0.13, 0.0)).norm(), 1e-12);
  EXPECT_NEAR(board.width_m(), 0.75, 1e-12);
}

TEST(BoardPrint, MeetsInSaddlesAtAllCorners) {
  const CalibrationBoard board;
  const BoardPrint print(board);
  constexpr double kStep_m = 1e-3;
  for (int index = 0; index < board.cornerCount(); ++index) {
    const Vec3 corner = board.corner_T(index);
    const auto black = [&](double x, double y) {
      return print.isBlack(corner.x() + x * kStep_m, corner.y() + y * kStep_m);
    };
    EXPECT_EQ(black(1, 1), black(-1, -1)) << index;
    EXPECT_EQ(black(1, -1), black(-1, 1)) << index;
    EXPECT_NE(black(1, 1), black(1, -1)) << index;
  }
  EXPECT_FALSE(print.isBlack(-0.1, -0.1));
}

/// An image of a plane by a homography from T (m) to pixels, with supersampling and the blur of a lens.
cv::Mat imageOf(const std::function<bool(double, double)>& is_black, const Mat3& image_from_board) {
  constexpr int kSamples = 6;
  const Mat3 board_from_image = image_from_board.inverse();
  cv::Mat image(480, 640, CV_32F);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      int black = 0;
      for (int k = 0; k < kSamples * kSamples; ++k) {
        const Vec3 at = board_from_image * Vec3(x - 0.5 + (k % kSamples + 0.5) / kSamples,
                                                y - 0.5 + (k / kSamples + 0.5) / kSamples, 1.0);
        black += is_black(at.x() / at.z(), at.y() / at.z()) ? 1 : 0;
      }
      image.at<float>(y, x) = 210.0f - 170.0f * static_cast<float>(black) / (kSamples * kSamples);
    }
  }
  cv::GaussianBlur(image, image, cv::Size(5, 5), 0.6);
  cv::Mat grey;
  image.convertTo(grey, CV_8U);
  return grey;
}

/// A plane seen aslant; the y axis of T points up.
Mat3 aslant(double turn_rad) {
  Mat3 h;
  h << 900.0, 40.0, 60.0, -30.0, -850.0, 440.0, 0.15, 0.1, 1.0;
  Mat3 about_centre = Mat3::Identity();
  const Vec2 centre(0.2, 0.2);
  const Eigen::Rotation2Dd turn(turn_rad);
  about_centre.topLeftCorner<2, 2>() = turn.toRotationMatrix();
  about_centre.topRightCorner<2, 1>() = centre - turn * centre;
  return h * about_centre;
}

const CalibrationBoard kBoard{.columns = 6, .rows = 6, .tag_size_m = 0.055, .spacing = 0.3};

TEST(BoardDetector, FindsCornersToAFewHundredthsOfAPixelInAnyAttitude) {
  const BoardPrint print(kBoard);
  const BoardDetector detector(kBoard);
  for (const double turn_rad : {0.0, 1.0, 2.2, 3.1, 4.5}) {
    const Mat3 h = aslant(turn_rad);
    const auto corners = detector.detect(imageOf([&](double x, double y) { return print.isBlack(x, y); }, h));
    ASSERT_GT(corners.size(), 110u) << turn_rad;
    double sum = 0.0;
    for (const BoardCorner& corner : corners) {
      const Vec3 at = kBoard.corner_T(corner.index) + Vec3::UnitZ();
      sum += (corner.pixel - (h * at).hnormalized()).squaredNorm();
    }
    EXPECT_LT(std::sqrt(sum / static_cast<double>(corners.size())), 0.07) << turn_rad;
  }
}

TEST(BoardDetector, FindsTagsWithOneCellOfBorderAndWithoutSquares) {
  const TagFamily family(1);
  const auto is_black = [&](double x_m, double y_m) {
    const int column = static_cast<int>(std::floor(x_m / kBoard.pitch_m())),
              row = static_cast<int>(std::floor(y_m / kBoard.pitch_m()));
    if (column < 0 || row < 0 || column >= kBoard.columns || row >= kBoard.rows) return false;
    const double x = (x_m - column * kBoard.pitch_m()) / kBoard.tag_size_m,
                 y = (y_m - row * kBoard.pitch_m()) / kBoard.tag_size_m;
    if (x >= 1.0 || y >= 1.0) return false;
    return family.isBlack(row * kBoard.columns + column, static_cast<int>(x * family.width()),
                          static_cast<int>((1.0 - y) * family.width()));
  };
  const Mat3 h = aslant(0.3);
  const auto corners = BoardDetector(kBoard).detect(imageOf(is_black, h));
  ASSERT_GT(corners.size(), 100u);
  // The corner of one black field is not a saddle: blur draws it in.
  for (const BoardCorner& corner : corners) {
    const Vec3 at = kBoard.corner_T(corner.index) + Vec3::UnitZ();
    EXPECT_LT((corner.pixel - (h * at).hnormalized()).norm(), 1.0);
  }
}

TEST(BoardDetector, FindsNothingWhereThereIsNoBoard) {
  cv::Mat noise(480, 640, CV_8U);
  cv::theRNG().state = 5;
  cv::randu(noise, 0, 255);
  const BoardDetector detector(kBoard);
  EXPECT_TRUE(detector.detect(noise).empty());
  EXPECT_TRUE(detector.detect(cv::Mat(480, 640, CV_8U, cv::Scalar(128))).empty());
  // A mirror image of the board has no tags of the family.
  const BoardPrint print(kBoard);
  cv::Mat mirrored;
  cv::flip(imageOf([&](double x, double y) { return print.isBlack(x, y); }, aslant(0.0)), mirrored, 1);
  EXPECT_TRUE(detector.detect(mirrored).empty());
}

}  // namespace
}  // namespace lodeline
