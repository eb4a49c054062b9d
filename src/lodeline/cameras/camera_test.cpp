#include "lodeline/cameras/camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

CameraCalibration calibrationWith(const char* model, std::vector<double> distortion) {
  CameraCalibration c;
  c.name = "cam0";
  c.width_px = 752;
  c.height_px = 480;
  c.fx_px = 458.654;
  c.fy_px = 457.296;
  c.cx_px = 367.215;
  c.cy_px = 248.375;
  c.model = model;
  c.distortion = std::move(distortion);
  return c;
}

std::vector<CameraCalibration> allModels() {
  CameraCalibration wide = calibrationWith("equidistant", {-0.012, 0.031, -0.045, 0.021});
  wide.fx_px = wide.fy_px = 190.0;
  return {calibrationWith("none", {}),
          calibrationWith("radial-tangential", {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05}),
          calibrationWith("radial-tangential", {-0.31, 0.12, 0.0008, -0.0011, -0.021}),
          calibrationWith("radial-tangential", {0.41, -0.12, 0.0008, -0.0011, 0.02, 0.77, -0.03, 0.01}),
          calibrationWith("equidistant", {-0.0132, -0.0017, 0.0103, -0.0055}),
          wide};
}

std::string nameOf(const CameraCalibration& c) {
  return (c.model.find("radial") == 0 ? "radial" : c.model) + "_" + std::to_string(c.distortion.size()) +
         "_" + std::to_string(static_cast<int>(c.fx_px));
}

class EveryCamera : public testing::TestWithParam<CameraCalibration> {
 protected:
  std::shared_ptr<const Camera> camera_ = makeCamera(GetParam());
};
INSTANTIATE_TEST_SUITE_P(Models, EveryCamera, testing::ValuesIn(allModels()),
                         [](const auto& info) { return nameOf(info.param); });

std::vector<Vec3> pointsInView() {
  std::vector<Vec3> points;
  for (double x = -0.8; x <= 0.81; x += 0.2) {
    for (double y = -0.5; y <= 0.51; y += 0.25) points.push_back(3.7 * Vec3(x, y, 1.0));
  }
  return points;
}

TEST_P(EveryCamera, ProjectsAsOpenCv) {
  const CameraCalibration& c = GetParam();
  const cv::Matx33d K(c.fx_px, 0, c.cx_px, 0, c.fy_px, c.cy_px, 0, 0, 1);
  for (const Vec3& point : pointsInView()) {
    const std::vector<cv::Point3d> in = {{point.x(), point.y(), point.z()}};
    std::vector<cv::Point2d> expected;
    if (c.model == "equidistant") {
      cv::fisheye::projectPoints(in, expected, cv::Vec3d(), cv::Vec3d(), K, c.distortion);
    } else {
      cv::projectPoints(in, cv::Vec3d(), cv::Vec3d(), K, c.distortion, expected);
    }
    const auto pixel = camera_->project(point);
    ASSERT_TRUE(pixel);
    EXPECT_NEAR(pixel->x(), expected[0].x, 1e-9);
    EXPECT_NEAR(pixel->y(), expected[0].y, 1e-9);
  }
}

TEST(RadialTangentialCamera, StopsWhereTheDistortionFoldsBack) {
  // r (1 - 0.3 r^2) rises until r = sqrt(1 / 0.9).
  const auto camera = makeCamera(calibrationWith("radial-tangential", {-0.3, 0.0, 0.0, 0.0}));
  const double fold = std::sqrt(1.0 / 0.9);
  EXPECT_NEAR(std::tan(camera->maxAngle_rad()), fold, 1e-9);
  EXPECT_TRUE(camera->project(Vec3(fold - 1e-6, 0.0, 1.0)));
  EXPECT_FALSE(camera->project(Vec3(fold + 1e-6, 0.0, 1.0)));
  const double edge_px = 367.215 + 458.654 * fold * 2.0 / 3.0;
  EXPECT_TRUE(camera->unproject(Vec2(edge_px - 1e-3, 248.375)));
  EXPECT_FALSE(camera->unproject(Vec2(edge_px + 1e-3, 248.375)));
}

TEST(RadialTangentialCamera, StopsBeforeThePoleOfTheRationalModel) {
  // The denominator 1 - 0.5 r^2 vanishes at r = sqrt(2).
  const auto camera =
      makeCamera(calibrationWith("radial-tangential", {0.0, 0.0, 0.0, 0.0, 0.0, -0.5, 0.0, 0.0}));
  EXPECT_NEAR(std::tan(camera->maxAngle_rad()), std::sqrt(2.0), 1e-9);
  EXPECT_FALSE(camera->project(Vec3(1.5, 0.0, 1.0)));
}

TEST(EquidistantCamera, StopsWhereTheDistortionFoldsBack) {
  // theta (1 - 0.4 theta^2) rises until theta = sqrt(1 / 1.2).
  const auto camera = makeCamera(calibrationWith("equidistant", {-0.4, 0.0, 0.0, 0.0}));
  const double fold = std::sqrt(1.0 / 1.2);
  EXPECT_NEAR(camera->maxAngle_rad(), fold, 1e-12);
  EXPECT_TRUE(camera->project(Vec3(std::tan(fold - 1e-6), 0.0, 1.0)));
  EXPECT_FALSE(camera->project(Vec3(std::tan(fold + 1e-6), 0.0, 1.0)));
  const double edge_px = 367.215 + 458.654 * fold * 2.0 / 3.0;
  EXPECT_TRUE(camera->unproject(Vec2(edge_px - 1e-3, 248.375)));
  EXPECT_FALSE(camera->unproject(Vec2(edge_px + 1e-3, 248.375)));
}

TEST(EquidistantCamera, SeesBeyondNinetyDegrees) {
  const auto camera = makeCamera(calibrationWith("equidistant", {0.0, 0.0, 0.0, 0.0}));
  const Vec3 ray(std::sin(1.7), 0.0, std::cos(1.7));
  const auto pixel = camera->project(ray);
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 367.215 + 458.654 * 1.7, 1e-9);
  EXPECT_LT((*camera->unproject(*pixel) - ray).norm(), 1e-12);
}

TEST(Camera, ContainsPixelsWithinTheBorder) {
  const auto camera = makeCamera(calibrationWith("none", {}));
  EXPECT_TRUE(camera->contains(Vec2(0.0, 0.0)));
  EXPECT_TRUE(camera->contains(Vec2(751.0, 479.0)));
  EXPECT_FALSE(camera->contains(Vec2(751.1, 479.0)));
  EXPECT_FALSE(camera->contains(Vec2(4.9, 100.0), 5.0));
  EXPECT_TRUE(camera->contains(Vec2(5.0, 100.0), 5.0));
}

void expectError(const CameraCalibration& calibration, const std::string& value) {
  try {
    makeCamera(calibration);
    FAIL() << "no error about " << value;
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("'cam0'"));
    EXPECT_THAT(error.what(), testing::HasSubstr(value));
  }
}

TEST(MakeCamera, NamesCameraAndValueOfWhatIsWrong) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expectError(calibrationWith("radial-tangential", {0.1, 0.2, 0.3}), "found 3");
  expectError(calibrationWith("radial-tangential", {}), "found 0");
  expectError(calibrationWith("equidistant", {0.1, 0.2, 0.3, 0.4, 0.5}), "found 5");
  expectError(calibrationWith("none", {0.1}), "1 distortion coefficients");
  expectError(calibrationWith("scaramuzza", {}), "no camera model 'scaramuzza'; there are none, ");
  expectError(calibrationWith("equidistant", {0.1, nan, 0.0, 0.0}), "nan");

  CameraCalibration c = calibrationWith("none", {});
  c.fy_px = -457.0;
  expectError(c, "-457");
  c.fy_px = 0.0;
  expectError(c, "focal length 0");
  c = calibrationWith("none", {});
  c.height_px = 0;
  expectError(c, "752 x 0");
  c = calibrationWith("none", {});
  c.cx_px = nan;
  expectError(c, "principal point nan");
}

}  // namespace
}  // namespace lodeline
