#include "lodeline/cameras/camera_file_keys.h"

#include <gmock/gmock.h>

#include "lodeline/cameras/test_camera_models.h"

namespace lodeline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class KeysOfACamera : public testing::TestWithParam<CameraCalibration> {};
INSTANTIATE_TEST_SUITE_P(Registered, KeysOfACamera, testing::ValuesIn(test::typicalCameras()),
                         test::testName);

TEST_P(KeysOfACamera, GiveTheCameraBack) {
  const CameraFileKeys keys = cameraFileKeys(GetParam());
  const CameraModel* model = findCameraModel(keys.camera_model, keys.distortion_model);
  ASSERT_NE(model, nullptr);
  EXPECT_EQ(model->name, GetParam().model);
  CameraCalibration again;
  setFromFileKeys(*model, keys, &again);
  EXPECT_EQ(again.fx_px, GetParam().fx_px);
  EXPECT_EQ(again.fy_px, GetParam().fy_px);
  EXPECT_EQ(again.cx_px, GetParam().cx_px);
  EXPECT_EQ(again.cy_px, GetParam().cy_px);
  EXPECT_EQ(again.distortion, GetParam().distortion);
}

TEST(CameraFileKeys, HaveKalibrsOrder) {
  CameraCalibration c = test::typicalCamera(*findCameraModel("omni"), 5);
  c.fx_px = 1.0, c.fy_px = 2.0, c.cx_px = 3.0, c.cy_px = 4.0;
  c.distortion = {0.9, 0.1, 0.2, 0.3, 0.4};
  CameraFileKeys keys = cameraFileKeys(c);
  EXPECT_EQ(keys.camera_model, "omni");
  EXPECT_EQ(keys.distortion_model, "radtan");
  EXPECT_THAT(keys.intrinsics, ElementsAre(0.9, 1.0, 2.0, 3.0, 4.0));
  EXPECT_THAT(keys.distortion_coefficients, ElementsAre(0.1, 0.2, 0.3, 0.4));
  c.model = "double-sphere";
  c.distortion = {-0.2, 0.6};
  keys = cameraFileKeys(c);
  EXPECT_EQ(keys.camera_model, "ds");
  EXPECT_EQ(keys.distortion_model, "none");
  EXPECT_THAT(keys.intrinsics, ElementsAre(-0.2, 0.6, 1.0, 2.0, 3.0, 4.0));
  EXPECT_EQ(intrinsicsNames(*findCameraModel("ds")), "xi, alpha, fx, fy, cx, cy");
}

TEST(CameraFileKeys, AreListedForMessages) {
  EXPECT_THAT(cameraFileModels(), HasSubstr("omni (radtan)"));
  EXPECT_THAT(cameraFileModels(), HasSubstr("pinhole (none, radial-tangential, equidistant, fov)"));
}

}  // namespace
}  // namespace lodeline
