#include "lodeline/output/walls/depth/rectified_view.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/cameras/test_camera_models.h"
#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// A pair whose second camera is turned a little and stands 12 cm to one side.
std::vector<CameraCalibration> pairOf(CameraCalibration camera, const Vec3& second_C) {
  camera.body_from_camera = Rigid3(so3::exp(Vec3(0.3, -0.2, 1.0)), Vec3(0.1, 0.2, -0.1));
  CameraCalibration second = camera;
  second.name = "cam1";
  second.body_from_camera = camera.body_from_camera * Rigid3(so3::exp(Vec3(0.02, -0.03, 0.01)), second_C);
  return {camera, second};
}

/// An image whose pixels hold their own column or row.
cv::Mat coordinateImage(const CameraCalibration& camera, bool is_row) {
  cv::Mat image(camera.height_px, camera.width_px, CV_32F);
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) image.at<float>(v, u) = static_cast<float>(is_row ? v : u);
  }
  return image;
}

/// Column of the second rectified image that shows a pixel of its camera, in a row.
std::optional<double> columnOf(const cv::Mat& columns, const cv::Mat& seen, int row, double column_px) {
  for (int u = 0; u + 1 < columns.cols; ++u) {
    if (seen.at<uint8_t>(row, u) == 0 || seen.at<uint8_t>(row, u + 1) == 0) continue;
    const double a = columns.at<float>(row, u), b = columns.at<float>(row, u + 1);
    if ((a - column_px) * (b - column_px) <= 0.0 && a != b) return u + (column_px - a) / (b - a);
  }
  return std::nullopt;
}

class RectifiedPair : public testing::TestWithParam<CameraCalibration> {
 protected:
  /// Depths from disparities against those of points on the first camera's lines of sight.
  void expectDepths(const std::vector<CameraCalibration>& cameras, double tolerance) const {
    RectificationOptions options;
    options.max_width_px = 320;
    const RectifiedView view(cameras, options);
    const auto first = makeCamera(cameras[0]), second = makeCamera(cameras[1]);
    const cv::Mat columns0 = view.rectify(0, coordinateImage(cameras[0], false));
    const cv::Mat rows0 = view.rectify(0, coordinateImage(cameras[0], true));
    const cv::Mat columns1 = view.rectify(1, coordinateImage(cameras[1], false));
    const Rigid3 second_from_first = cameras[1].body_from_camera.inverse() * cameras[0].body_from_camera;
    const Rigid3 view_from_first = view.body_from_view().inverse() * cameras[0].body_from_camera;
    int tested = 0;
    for (int v = 20; v < columns0.rows; v += 31) {
      for (int u = 30; u < columns0.cols; u += 37) {
        if (view.seen(0).at<uint8_t>(v, u) == 0) continue;
        const auto line = first->viewRay(Vec2(columns0.at<float>(v, u), rows0.at<float>(v, u)));
        if (!line) continue;
        const Vec3 point_C = line->fromNearestPoint().origin_C + 2.0 * line->direction_C;
        const auto pixel = second->project(second_from_first * point_C);
        if (!pixel || !second->contains(*pixel, 2.0)) continue;
        const auto column = columnOf(columns1, view.seen(1), v, pixel->x());
        if (!column) continue;
        const double depth_m = (view_from_first * point_C).z();
        EXPECT_NEAR(view.depth_m(u, v, u - *column), depth_m, tolerance * depth_m) << u << " " << v;
        ++tested;
      }
    }
    EXPECT_GT(tested, 8);
  }
};

TEST_P(RectifiedPair, GivesDepthsOfItsModel) { expectDepths(pairOf(GetParam(), {0.12, 0.0, 0.01}), 0.02); }

TEST_P(RectifiedPair, TakesTheSecondCameraOnAnySide) {
  expectDepths(pairOf(GetParam(), {-0.12, 0.01, 0.0}), 0.02);
}

INSTANTIATE_TEST_SUITE_P(Models, RectifiedPair, testing::ValuesIn(test::typicalCameras()), test::testName);

TEST(RectifiedView, KeepsRowsEqual) {
  const auto cameras =
      pairOf(test::typicalCamera(*findCameraModel("radial-tangential"), 4), {0.12, 0.0, 0.0});
  const RectifiedView view(cameras, {});
  const cv::Mat rows = view.rectify(1, coordinateImage(cameras[1], true));
  const cv::Mat columns = view.rectify(1, coordinateImage(cameras[1], false));
  const Vec3 point_V = 3.0 * view.pinhole().direction(300, 200);
  const Rigid3 second_from_view = cameras[1].body_from_camera.inverse() * view.body_from_view();
  const Vec2 pixel = makeCamera(cameras[1])->project(second_from_view * point_V).value();
  const double column = columnOf(columns, view.seen(1), 200, pixel.x()).value();
  EXPECT_NEAR(rows.at<float>(200, static_cast<int>(column + 0.5)), pixel.y(), 0.5);
  EXPECT_LT(column, 300.0);
}

TEST(RectifiedView, IsExactBehindAPort) {
  auto camera = test::typicalCamera(*findCameraModel("none"), 0);
  Port port;
  port.distance_m = 0.03;
  port.thickness_m = 0.01;
  camera.port = port;
  const auto cameras = pairOf(camera, {0.14, 0.0, 0.0});
  const RectifiedView view(cameras, {});
  const auto first = makeCamera(cameras[0]), second = makeCamera(cameras[1]);
  const Rigid3 second_from_view = cameras[1].body_from_camera.inverse() * view.body_from_view();
  const Rigid3 view_from_first = view.body_from_view().inverse() * cameras[0].body_from_camera;
  const cv::Mat columns0 = view.rectify(0, coordinateImage(cameras[0], false));
  const cv::Mat rows0 = view.rectify(0, coordinateImage(cameras[0], true));
  const cv::Mat columns1 = view.rectify(1, coordinateImage(cameras[1], false));
  for (const double distance_m : {0.8, 2.0, 5.0}) {
    const auto line = first->viewRay(Vec2(columns0.at<float>(150, 260), rows0.at<float>(150, 260))).value();
    const Vec3 point_V = view_from_first * (line.origin_C + distance_m * line.direction_C);
    const Vec2 pixel = second->project(second_from_view * point_V).value();
    const double column = columnOf(columns1, view.seen(1), 150, pixel.x()).value();
    EXPECT_NEAR(view.depth_m(260, 150, 260 - column), point_V.z(), 0.01 * point_V.z()) << distance_m;
  }
}

TEST(RectifiedView, RefusesCamerasThatLookApart) {
  auto cameras = pairOf(test::typicalCamera(*findCameraModel("none"), 0), {0.12, 0.0, 0.0});
  cameras[1].body_from_camera.rotation = cameras[0].body_from_camera.rotation * so3::exp(Vec3(0.0, 2.5, 0.0));
  EXPECT_THAT([&] { RectifiedView(cameras, {}); }, ThrowsMessage<InputError>(HasSubstr("beside each other")));
  cameras = pairOf(cameras[0], {0.0, 0.0, 0.3});
  EXPECT_THAT([&] { RectifiedView(cameras, {}); }, ThrowsMessage<InputError>(HasSubstr("beside each other")));
}

}  // namespace
}  // namespace lodeline
