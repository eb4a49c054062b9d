#include "lodeline/cameras/fit_camera.h"

#include <gtest/gtest.h>

#include "lodeline/cameras/test_camera_models.h"
#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

class FitOfACamera : public testing::TestWithParam<CameraCalibration> {};
INSTANTIATE_TEST_SUITE_P(Registered, FitOfACamera, testing::ValuesIn(test::typicalCameras()), test::testName);

TEST_P(FitOfACamera, FindsTheCameraAgain) {
  const auto truth = makeCamera(GetParam());
  CameraCalibration start = GetParam();
  start.fx_px *= 1.02;
  start.cy_px -= 3.0;
  for (double& parameter : start.distortion) parameter *= 0.9;
  const CameraFit fit = fitCamera(start, imageObservations(*truth));
  EXPECT_LT(fit.rms_px, 1e-3);
  const auto found = makeCamera(fit.calibration);
  for (const Vec2& pixel : {Vec2(20, 30), Vec2(370, 400), Vec2(700, 100)})
    EXPECT_LT((*found->project(*truth->unproject(pixel)) - pixel).norm(), 0.01) << pixel.transpose();
}

// The equidistant model has enough coefficients to describe every lens of the simulator.
TEST_P(FitOfACamera, TurnsItIntoAnEquidistantOne) {
  const CameraFit fit = convertedCamera(GetParam(), *findCameraModel("equidistant"));
  EXPECT_EQ(fit.calibration.model, "equidistant");
  EXPECT_LT(fit.rms_px, 0.3);
  const auto truth = makeCamera(GetParam()), found = makeCamera(fit.calibration);
  EXPECT_LT((*found->project(*truth->unproject(Vec2(250, 200))) - Vec2(250, 200)).norm(), 1.0);
}

TEST(FitCamera, StatesWhatRemains) {
  const CameraCalibration fisheye = test::typicalCamera(*findCameraModel("ds"), 2);
  const CameraFit fit = convertedCamera(fisheye, *findCameraModel("none"));
  const auto truth = makeCamera(fisheye), found = makeCamera(fit.calibration);
  double squared_sum = 0.0;
  int count = 0;
  for (double x = 0.0; x < fisheye.width_px; x += 31.0) {
    for (double y = 0.0; y < fisheye.height_px; y += 31.0) {
      const auto pixel = found->project(*truth->unproject(Vec2(x, y)));
      if (!pixel) continue;
      squared_sum += (*pixel - Vec2(x, y)).squaredNorm();
      ++count;
    }
  }
  const double rms_px = std::sqrt(squared_sum / count);
  EXPECT_GT(rms_px, 3.0) << "a pinhole camera is no fisheye";
  EXPECT_NEAR(fit.rms_px / rms_px, 1.0, 0.1);
}

TEST(FitCamera, RefusesAStartThatIsNoCamera) {
  CameraCalibration c = test::typicalCamera(*findCameraModel("ds"), 2);
  c.distortion = {3.0, 0.5};
  EXPECT_THROW(fitCamera(c, {}), InputError);
}

}  // namespace
}  // namespace lodeline
