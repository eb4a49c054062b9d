#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>

#include "lodeline/board/tag_family.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/control/control_residual.h"
#include "lodeline/mapping/control/tags/tag_control.h"
#include "lodeline/mapping/control/tags/tag_pose.h"

// Tests of tags on the line, in images made from their print.

namespace lodeline {
namespace {

using ::testing::IsEmpty;

constexpr double kSize_m = 0.10;

CameraCalibration testCamera() {
  CameraCalibration calibration;
  calibration.width_px = 640;
  calibration.height_px = 480;
  calibration.fx_px = calibration.fy_px = 450.0;
  calibration.cx_px = 319.5;
  calibration.cy_px = 239.5;
  return calibration;
}

/// Grey value of the print at a place of the tag frame (m): the tag, one cell of white around it, then grey.
double printAt(const TagFamily& family, int tag, double x_m, double y_m) {
  const double cell_m = kSize_m / family.width();
  const double column = (x_m + 0.5 * kSize_m) / cell_m, row = (0.5 * kSize_m - y_m) / cell_m;
  const double edge = family.width();
  if (column < -1.5 || row < -1.5 || column > edge + 1.5 || row > edge + 1.5) return 110.0;
  if (column < 0 || row < 0 || column >= edge || row >= edge) return 230.0;
  return family.isBlack(tag, static_cast<int>(column), static_cast<int>(row)) ? 20.0 : 230.0;
}

/// Draws a tag into an image, the mean of 5 x 5 rays for each pixel, then a little blur.
void draw(int tag, const Rigid3& camera_from_tag, cv::Mat* image) {
  const TagFamily family(1);
  const auto camera = makeCamera(testCamera());
  const Rigid3 tag_from_camera = camera_from_tag.inverse();
  for (int v = 0; v < image->rows; ++v) {
    for (int u = 0; u < image->cols; ++u) {
      double sum = 0.0;
      for (int i = 0; i < 25; ++i) {
        const Vec3 bearing = camera->unproject(Vec2(u + (i % 5 - 2) * 0.2, v + (i / 5 - 2) * 0.2)).value();
        const Vec3 direction = tag_from_camera.rotation * bearing;
        const double scale = -tag_from_camera.translation.z() / direction.z();
        const Vec3 place = tag_from_camera.translation + scale * direction;
        const bool is_tag = place.head<2>().cwiseAbs().maxCoeff() < kSize_m;
        sum += is_tag ? printAt(family, tag, place.x(), place.y()) : image->at<uchar>(v, u);
      }
      image->at<uchar>(v, u) = static_cast<uchar>(std::lround(sum / 25.0));
    }
  }
}

/// A tag at a place before the camera (z forward), facing it and then turned by a rotation vector of the tag.
Rigid3 facing(const Vec3& place, const Vec3& turn) {
  Mat3 facing;  // x right, y up, z towards the camera
  facing << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  return Rigid3((Quat(facing) * so3::exp(turn)).normalized(), place);
}

class TagObserverTest : public ::testing::Test {
 protected:
  TagObserver observer(double size_m) const {
    TagOptions options;
    options.size_m = size_m;
    return TagObserver(makeCamera(testCamera()), body_from_camera_, 0, options);
  }
  cv::Mat image() const { return cv::Mat(480, 640, CV_8U, cv::Scalar(110)); }

  const Rigid3 body_from_camera_{so3::exp(Vec3(0.3, -1.2, 0.4)), Vec3(0.05, -0.1, 0.02)};
};

TEST_F(TagObserverTest, FindsTagsWithTheirPlaceInTheBody) {
  cv::Mat view = image();
  const Rigid3 left = facing(Vec3(-0.25, 0.05, 0.9), Vec3(0.2, 0.4, 0.3));
  const Rigid3 right = facing(Vec3(0.2, -0.1, 0.7), Vec3(-0.5, 0.1, 2.0));
  draw(301, left, &view);
  draw(17, right, &view);
  const std::vector<TagObservation> observations = observer(kSize_m).observe(view);
  ASSERT_EQ(observations.size(), 2u);
  EXPECT_EQ(observations[0].tag, 17);
  EXPECT_EQ(observations[1].tag, 301);
  for (const TagObservation& observation : observations) {
    const Rigid3& camera_from_tag = observation.tag == 17 ? right : left;
    const Vec3 error = observation.centre_B->position - body_from_camera_ * camera_from_tag.translation;
    EXPECT_LT(error.dot(observation.centre_B->covariance.ldlt().solve(error)), 16.3);
    EXPECT_LT(error.norm(), 0.02 * camera_from_tag.translation.norm());
    for (int k = 0; k < 4; ++k) {
      const double x = k == 0 || k == 3 ? -0.5 : 0.5, y = k < 2 ? -0.5 : 0.5;
      const Vec3 corner_B = body_from_camera_ * (camera_from_tag * (kSize_m * Vec3(x, y, 0)));
      const BodyRay& ray = observation.corners[static_cast<size_t>(k)];
      const Vec3 expected = (corner_B - ray.origin_B).normalized();
      EXPECT_LT((ray.bearing_B - expected).norm(), 4.0 * ray.sigma_rad) << "corner " << k;
      EXPECT_NEAR(ray.sigma_rad, 0.3 / 450.0, 0.3 * 0.3 / 450.0);
    }
  }
}

TEST_F(TagObserverTest, GivesRaysAloneWhereTheSizeIsUnknown) {
  cv::Mat view = image();
  draw(5, facing(Vec3(0, 0, 0.8), Vec3(0, 0.2, 0)), &view);
  const std::vector<TagObservation> observations = observer(0.0).observe(view);
  ASSERT_EQ(observations.size(), 1u);
  EXPECT_FALSE(observations[0].centre_B);
  ControlSet control;
  EXPECT_THAT(factorsOfTags(1, observations, &control), IsEmpty());
}

TEST_F(TagObserverTest, LeavesOutATagThatIsSeenTwiceAndOneTooSmall) {
  cv::Mat twice = image();
  draw(5, facing(Vec3(-0.2, 0, 0.8), Vec3(0, 0.2, 0)), &twice);
  EXPECT_EQ(observer(kSize_m).observe(twice).size(), 1u);
  draw(5, facing(Vec3(0.2, 0, 0.8), Vec3(0, 0.2, 0)), &twice);
  EXPECT_THAT(observer(kSize_m).observe(twice), IsEmpty());
  cv::Mat small = image();
  draw(5, facing(Vec3(0, 0, 4.5), Vec3::Zero()), &small);
  EXPECT_THAT(observer(kSize_m).observe(small), IsEmpty());
}

TEST_F(TagObserverTest, CountsASquareThatBothBordersDecodeOnce) {
  cv::Mat view = image();
  draw(17, facing(Vec3(0.2, -0.1, 0.7), Vec3(-0.5, 0.1, 2.0)), &view);
  TagOptions options;
  options.most_wrong_bits = 2;
  const TagObserver observer(makeCamera(testCamera()), body_from_camera_, 0, options);
  ASSERT_GE(TagDetector().find(view, 587).size(), 2u) << "the wide border decodes it too, with a wrong bit";
  EXPECT_EQ(observer.observe(view).size(), 1u);
}

TEST_F(TagObserverTest, FindsNoTagInNoise) {
  std::mt19937 random(1);
  for (int i = 0; i < 20; ++i) {
    cv::Mat cells(60, 80, CV_8U), view;
    for (int k = 0; k < 4800; ++k) cells.data[k] = random() % 2 == 0 ? 20 : 230;
    cv::resize(cells, view, cv::Size(640, 480), 0, 0, cv::INTER_NEAREST);
    EXPECT_THAT(observer(kSize_m).observe(view), IsEmpty());
  }
}

TEST_F(TagObserverTest, NamesATagAtTwoPlaces) {
  const auto observationAt = [](const Vec3& centre_B) {
    TagObservation observation;
    observation.tag = 9;
    observation.centre_B = PositionPrior{centre_B, 1e-4 * Mat3::Identity()};
    return observation;
  };
  ControlSet control;
  std::vector<ControlFactor> factors;
  for (const auto& [keyframe, place] :
       {std::pair<KeyframeId, Vec3>{1, {1, 0, 0}}, {2, {1, 0, 0.01}}, {3, {1, 2, 0}}}) {
    const TagObservation observation = observationAt(place);
    for (ControlFactor& factor : factorsOfTags(keyframe, std::span(&observation, 1), &control))
      factors.push_back(factor);
  }
  ASSERT_EQ(control.points.size(), 1u);
  EXPECT_EQ(control.points[0].name, "tag 9");
  EXPECT_EQ(control.points[0].tag, 9);
  const auto residuals =
      controlResiduals(factors, [](KeyframeId) { return std::optional<SolvedPose>(SolvedPose()); });
  ASSERT_EQ(blunderTexts(residuals).size(), 1u);
  EXPECT_TRUE(residuals[2].is_blunder);
}

TEST_F(TagObserverTest, RefusesImpossibleOptions) {
  EXPECT_THROW(observer(-1.0), UsageError);
  TagOptions options;
  options.corner_sigma_px = 0.0;
  EXPECT_THROW(options.check(), UsageError);
  options = {};
  options.sizes_m[3] = 0.0;
  EXPECT_THROW(options.check(), UsageError);
}

TEST(TagPoseTest, ErrorsAreAsLargeAsTheirCovariance) {
  const Rigid3 camera_from_tag = facing(Vec3(0.1, -0.05, 0.8), Vec3(0.5, -0.4, 0.2));
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  constexpr int kDraws = 600;
  constexpr double kSigma_rad = 5e-4;
  double sum = 0.0;
  int count = 0;
  for (int i = 0; i < kDraws; ++i) {
    std::array<BodyRay, 4> corners;
    for (size_t k = 0; k < 4; ++k) {
      const double x = k == 0 || k == 3 ? -0.5 : 0.5, y = k < 2 ? -0.5 : 0.5;
      const Vec3 bearing = (camera_from_tag * (kSize_m * Vec3(x, y, 0))).normalized();
      const Vec2 error = kSigma_rad * Vec2(normal(random), normal(random));
      corners[k].bearing_B = (bearing + tangentBasis(bearing) * error).normalized();
      corners[k].sigma_rad = kSigma_rad;
    }
    const auto pose = tagPose(corners, kSize_m);
    ASSERT_TRUE(pose);
    const Vec3 error = pose->centre_B.position - camera_from_tag.translation;
    sum += error.dot(pose->centre_B.covariance.ldlt().solve(error));
    ++count;
  }
  // One sigma of the mean is sqrt(6 / 600) = 0.1.
  EXPECT_NEAR(sum / count, 3.0, 0.4);
}

TEST(TagPoseTest, RefusesWhatIsNoSquareInFront) {
  std::array<BodyRay, 4> corners;
  EXPECT_FALSE(tagPose(corners, kSize_m)) << "all in one direction";
  for (size_t k = 0; k < 4; ++k) corners[k].bearing_B = Vec3(0.1 * static_cast<double>(k), 0, 1).normalized();
  EXPECT_FALSE(tagPose(corners, kSize_m)) << "on a line";
}

}  // namespace
}  // namespace lodeline
