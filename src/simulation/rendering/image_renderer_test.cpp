#include "simulation/rendering/image_renderer.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "lodeline/cameras/camera_model.h"
#include "lodeline/geometry/so3.h"
#include "simulation/rendering/test_render.h"

namespace lodeline {
namespace {

constexpr double kTime_s = 14.0;

WorldFromBodyAt swim() { return RenderFixture::swim(RenderFixture::shortPassage()); }

bool sameBytes(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && cv::countNonZero(a != b) == 0;
}

double median(std::vector<double> values) {
  EXPECT_FALSE(values.empty());
  if (values.empty()) return 1e9;
  std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

std::vector<cv::Point2f> cornersOf(const cv::Mat& image, int most) {
  std::vector<cv::Point2f> corners;
  // The quality is relative to the best corner, often a bright flake of snow.
  cv::goodFeaturesToTrack(image, corners, most, 0.004, 8);
  return corners;
}

/// Lucas-Kanade tracking forward and backward. Points that do not return within half a pixel are removed from
/// `from`.
std::vector<cv::Point2f> track(const cv::Mat& first, const cv::Mat& second, std::vector<cv::Point2f>& from) {
  const cv::TermCriteria stop(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 40, 0.005);
  std::vector<cv::Point2f> to, back;
  std::vector<uint8_t> there_found, back_found;
  std::vector<float> error;
  cv::calcOpticalFlowPyrLK(first, second, from, to, there_found, error, cv::Size(15, 15), 3, stop);
  back = from;
  cv::calcOpticalFlowPyrLK(second, first, to, back, back_found, error, cv::Size(15, 15), 3, stop,
                           cv::OPTFLOW_USE_INITIAL_FLOW);
  std::vector<cv::Point2f> kept_from, kept_to;
  for (size_t i = 0; i < from.size(); ++i) {
    if (there_found[i] && back_found[i] && cv::norm(back[i] - from[i]) < 0.5) {
      kept_from.push_back(from[i]);
      kept_to.push_back(to[i]);
    }
  }
  from = kept_from;
  return kept_to;
}

TEST(ImageRenderer, SameBytesWhateverTheThreadsAndTheOrder) {
  RenderSettings settings = RenderSettings::field();
  settings.water.silt = {{kTime_s - 1.0, 4.0, 1.0}};
  settings.sensor.readout_s = 0.015;
  const Rig rig = RenderFixture::stereoRig(0.25);
  const ImageRenderer renderer(RenderFixture::shortCave(), rig, settings);
  const cv::Mat first = renderer.render(1, swim(), kTime_s);
  renderer.render(0, swim(), kTime_s + 3.0);
  EXPECT_TRUE(sameBytes(first, renderer.render(1, swim(), kTime_s)));
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_TRUE(
      sameBytes(first, ImageRenderer(RenderFixture::shortCave(), rig, settings).render(1, swim(), kTime_s)));
  settings.seed = 2;
  EXPECT_FALSE(
      sameBytes(first, ImageRenderer(RenderFixture::shortCave(), rig, settings).render(1, swim(), kTime_s)));
}

/// Traces the points of corners of one noise-free image, projects them into a later image and compares them
/// with the optical flow there.
/// Median distance between points tracked from image to image and the projections of the rendered surface.
double medianError_px(const Rig& rig) {
  const ImageRenderer renderer(RenderFixture::shortCave(), rig, RenderSettings::ideal());
  const auto motion = swim();
  const double later_s = kTime_s + 0.2;
  const cv::Mat first = renderer.render(0, motion, kTime_s), second = renderer.render(0, motion, later_s);
  std::vector<cv::Point2f> from = cornersOf(first, 400);
  const std::vector<cv::Point2f> to = track(first, second, from);
  const auto camera = makeCamera(rig.cameras[0]);
  const Rigid3 camera_from_world = (motion(later_s) * rig.cameras[0].body_from_camera).inverse();
  std::vector<double> errors_px;
  for (size_t i = 0; i < from.size(); ++i) {
    const auto point_W = renderer.hitPoint(0, Vec2(from[i].x, from[i].y), motion(kTime_s));
    EXPECT_TRUE(point_W);
    const auto pixel = point_W ? camera->project(camera_from_world * *point_W) : std::nullopt;
    if (pixel) errors_px.push_back((*pixel - Vec2(to[i].x, to[i].y)).norm());
  }
  EXPECT_GT(errors_px.size(), 200u);
  return median(errors_px);
}

TEST(ImageRenderer, LandmarksAppearWhereTheyProject) {
  const double error_px = medianError_px(RenderFixture::stereoRig());
  RecordProperty("median_error_px", std::to_string(error_px));
  EXPECT_LE(error_px, 0.1);
}

TEST(ImageRenderer, RendersThroughEveryCameraModel) {
  for (const CameraModel& model : cameraModels()) {
    Rig rig = RenderFixture::stereoRig();
    CameraCalibration& camera = rig.cameras[0];
    camera.model = model.name;
    camera.distortion = model.typical.parameters;
    const double focal_px = model.typical.focal_length_share * camera.width_px;
    camera.fx_px = camera.fy_px = focal_px;
    camera.fx_px = camera.fy_px = focal_px * focal_px / focalLengthOnAxis_px(camera);
    EXPECT_LE(medianError_px(rig), 0.15) << model.name;
  }
}

TEST(ImageRenderer, StereoPairsLieOnTheirEpipolarLines) {
  const Rig rig = RenderFixture::stereoRig();
  const ImageRenderer renderer(RenderFixture::shortCave(), rig, RenderSettings::ideal());
  const cv::Mat left = renderer.render(0, swim(), kTime_s), right = renderer.render(1, swim(), kTime_s);
  std::vector<cv::Point2f> from = cornersOf(left, 400);
  const std::vector<cv::Point2f> to = track(left, right, from);
  const Rigid3 right_from_left = rig.cameras[1].body_from_camera.inverse() * rig.cameras[0].body_from_camera;
  const Mat3 essential = so3::skew(right_from_left.translation) * right_from_left.rotation.toRotationMatrix();
  const auto left_camera = makeCamera(rig.cameras[0]), right_camera = makeCamera(rig.cameras[1]);
  std::vector<double> errors_px;
  for (size_t i = 0; i < from.size(); ++i) {
    const auto left_ray = left_camera->unproject(Vec2(from[i].x, from[i].y));
    const auto right_ray = right_camera->unproject(Vec2(to[i].x, to[i].y));
    ASSERT_TRUE(left_ray && right_ray);
    const Vec3 plane = (essential * *left_ray).normalized();
    errors_px.push_back(std::abs(plane.dot(*right_ray)) * rig.cameras[1].fx_px);
  }
  EXPECT_GT(errors_px.size(), 150u);
  const double error_px = median(errors_px);
  RecordProperty("median_error_px", std::to_string(error_px));
  EXPECT_LE(error_px, 0.1);
}

class Realism : public testing::TestWithParam<bool> {};

TEST_P(Realism, CornersAreManyAndSurviveTenFrames) {
  const RenderSettings settings = GetParam() ? RenderSettings::field() : RenderSettings::clean();
  const ImageRenderer renderer(RenderFixture::shortCave(), RenderFixture::stereoRig(), settings);
  cv::Mat before = renderer.render(0, swim(), kTime_s);
  std::vector<cv::Point2f> tracks = cornersOf(before, 600);
  EXPECT_GE(tracks.size(), 300u);
  RecordProperty("corners", static_cast<int>(tracks.size()));
  for (int frame = 1; frame <= 10; ++frame) {
    const cv::Mat now = renderer.render(0, swim(), kTime_s + frame / 15.0);
    tracks = track(before, now, tracks);
    before = now;
  }
  RecordProperty("surviving", static_cast<int>(tracks.size()));
  EXPECT_GE(tracks.size(), 150u);
}

INSTANTIATE_TEST_SUITE_P(CleanAndField, Realism, testing::Bool(),
                         [](const auto& info) { return info.param ? "Field" : "Clean"; });

TEST(ImageRenderer, ExposureFollowsTheSceneButNotSiltsContrast) {
  RenderSettings settings = RenderSettings::clean();
  settings.sensor.noise = false;
  settings.snow.flakes_per_m3 = 0.0;
  settings.water.silt = {{kTime_s - 2.0, 6.0, 3.0}};
  const ImageRenderer renderer(RenderFixture::shortCave(), RenderFixture::stereoRig(0.5), settings);
  // The pose is constant while silt appears.
  const Rigid3 pose = swim()(kTime_s);
  const WorldFromBodyAt still = [&](double) { return pose; };
  const cv::Mat clear = renderer.render(0, still, kTime_s - 3.0), silty = renderer.render(0, still, kTime_s);
  EXPECT_NEAR(cv::mean(clear)[0], 255.0 * settings.sensor.target_grey, 20.0);
  cv::Mat clear_edges, silty_edges;
  cv::Laplacian(clear, clear_edges, CV_32F);
  cv::Laplacian(silty, silty_edges, CV_32F);
  EXPECT_LT(cv::norm(silty_edges), 0.35 * cv::norm(clear_edges));
}

TEST(ImageRenderer, RollingShutterShearsWhatItPans) {
  RenderSettings settings = RenderSettings::ideal();
  const Rig rig = RenderFixture::stereoRig(0.5);
  const Rigid3 pose = swim()(kTime_s);
  const WorldFromBodyAt pan = [&](double time_s) {
    return pose * Rigid3(Quat(Eigen::AngleAxisd(time_s - kTime_s, Vec3::UnitZ())), Vec3::Zero());
  };
  const cv::Mat global = ImageRenderer(RenderFixture::shortCave(), rig, settings).render(0, pan, kTime_s);
  settings.sensor.readout_s = 0.03;
  const cv::Mat rolling = ImageRenderer(RenderFixture::shortCave(), rig, settings).render(0, pan, kTime_s);
  std::vector<cv::Point2f> from = cornersOf(global, 300);
  const std::vector<cv::Point2f> to = track(global, rolling, from);
  ASSERT_GT(from.size(), 60u);
  // The lower rows are exposed later. At 1 rad/s and a focal length of 210 px, the shift is 6.3 px times
  // their relative row.
  double covariance = 0.0, variance = 0.0;
  for (size_t i = 0; i < from.size(); ++i) {
    const double row = from[i].y / rig.cameras[0].height_px - 0.5;
    covariance += row * (to[i].x - from[i].x);
    variance += row * row;
  }
  EXPECT_NEAR(covariance / variance, 0.03 * rig.cameras[0].fx_px, 1.2);
}

}  // namespace
}  // namespace lodeline
