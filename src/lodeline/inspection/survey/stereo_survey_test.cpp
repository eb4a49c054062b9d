#include "lodeline/inspection/survey/stereo_survey.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <random>

#include "lodeline/cameras/camera.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;

class StereoSurveyTest : public testing::Test {
 protected:
  StereoSurveyTest() {
    left_.name = "cam0";
    left_.width_px = 640;
    left_.height_px = 480;
    left_.fx_px = left_.fy_px = 420.0;
    left_.cx_px = 325.0;
    left_.cy_px = 238.0;
    right_ = left_;
    right_.name = "cam1";
    left_.body_from_camera = Rigid3(so3::exp(Vec3(-1.55, 0.02, 0.03)), Vec3(0.05, 0.1, 0.02));
    right_.body_from_camera =
        Rigid3(left_.body_from_camera.rotation * so3::exp(Vec3(0.004, -0.01, 0.006)), Vec3(0.2, 0.1, 0.02));
  }

  /// Points in both images, at 1 to 4 m, with half a pixel of noise.
  std::vector<PointPair> points() const {
    std::mt19937 generator(5);
    std::uniform_real_distribution<double> column(40.0, 600.0), row(40.0, 440.0), depth_m(1.0, 4.0);
    std::normal_distribution<double> noise_px(0.0, 0.5);
    const auto left = makeCamera(left_), right = makeCamera(right_);
    const Rigid3 right_from_left = right_.body_from_camera.inverse() * left_.body_from_camera;
    std::vector<PointPair> pairs;
    while (pairs.size() < 300) {
      const Vec2 pixel(column(generator), row(generator));
      const Vec3 point = depth_m(generator) * *left->unproject(pixel);
      const std::optional<Vec2> seen = right->project(right_from_left * point);
      if (!seen || !right->contains(*seen)) continue;
      pairs.push_back({pixel, *seen + Vec2(noise_px(generator), noise_px(generator))});
    }
    return pairs;
  }

  CameraCalibration left_, right_;
};

TEST_F(StereoSurveyTest, AgreesWithARightCalibration) {
  const StereoSurvey survey = compareStereo(left_, right_, points());
  EXPECT_GT(survey.points, 150);
  EXPECT_GT(survey.agreement, 0.98);
  EXPECT_THAT(survey.fitting, ElementsAre(StereoHypothesis::AsCalibrated));
  EXPECT_NEAR(survey.baseline_m, 0.15, 1e-12);
  EXPECT_EQ(survey.turn_rad, 0.0);
}

TEST_F(StereoSurveyTest, AgreesWithACalibrationThatIsHalfADegreeOff) {
  const std::vector<PointPair> seen = points();
  right_.body_from_camera.rotation = right_.body_from_camera.rotation * so3::exp(Vec3(0.008, 0.003, 0.003));
  const StereoSurvey survey = compareStereo(left_, right_, seen);
  EXPECT_GT(survey.agreement, 0.9);
  // Only the part that epipolar lines show, not that which changes depths.
  EXPECT_NEAR(survey.turn_rad, std::hypot(0.008, 0.003), 0.001);
}

TEST(CopiesOfImages, AreTakenForNoPair) {
  cv::RNG random(3);
  cv::Mat noise(240, 320, CV_8U), image, shifted, other_exposure;
  random.fill(noise, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(noise, image, {}, 2.0);
  cv::normalize(image, image, 0, 255, cv::NORM_MINMAX);
  const cv::Mat by_a_pixel = (cv::Mat_<double>(2, 3) << 1.0, 0.0, 1.0, 0.0, 1.0, 0.0);
  cv::warpAffine(image, shifted, by_a_pixel, image.size());
  image.convertTo(other_exposure, -1, 0.9);
  const auto areCopiesOf = [&](const cv::Mat& second) {
    return areCopies(image, second, matchStereo(image, second, cv::Mat()));
  };
  EXPECT_TRUE(areCopiesOf(image));
  EXPECT_FALSE(areCopiesOf(shifted));
  EXPECT_FALSE(areCopiesOf(other_exposure));
  const cv::Mat dark = cv::Mat::zeros(240, 320, CV_8U);
  EXPECT_FALSE(areCopies(dark, dark, matchStereo(dark, dark, cv::Mat())));
}

TEST_F(StereoSurveyTest, NamesExchangedImages) {
  std::vector<PointPair> exchanged = points();
  for (PointPair& pair : exchanged) std::swap(pair.first, pair.second);
  const StereoSurvey survey = compareStereo(left_, right_, exchanged);
  EXPECT_LT(survey.agreement, 0.05);
  EXPECT_THAT(survey.fitting, Contains(StereoHypothesis::ImagesExchanged));
  EXPECT_GT(survey.best_agreement, 0.98);
}

TEST_F(StereoSurveyTest, NamesInvertedExtrinsics) {
  const std::vector<PointPair> seen = points();
  left_.body_from_camera = left_.body_from_camera.inverse();
  right_.body_from_camera = right_.body_from_camera.inverse();
  const StereoSurvey survey = compareStereo(left_, right_, seen);
  EXPECT_LT(survey.agreement, 0.3);
  EXPECT_THAT(survey.fitting, Contains(StereoHypothesis::ExtrinsicsInverted));
  EXPECT_GT(survey.best_agreement, 0.98);
}

TEST_F(StereoSurveyTest, SaysNothingOfCamerasInOnePlace) {
  const std::vector<PointPair> seen = points();
  right_.body_from_camera.translation = left_.body_from_camera.translation;
  const StereoSurvey survey = compareStereo(left_, right_, seen);
  EXPECT_EQ(survey.baseline_m, 0.0);
  EXPECT_EQ(survey.points, 0);
}

}  // namespace
}  // namespace lodeline
