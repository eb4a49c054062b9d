// What moves in the water moves in the images: snow with a current, shadows with a fish, light with a torch.
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "simulation/rendering/test_render.h"

namespace lodeline {
namespace {

constexpr double kMiddle_s = 14.0;

/// A view that does not move.
WorldFromBodyAt stillView() {
  const Rigid3 pose = RenderFixture::swim(RenderFixture::shortPassage())(kMiddle_s);
  return [pose](double) { return pose; };
}

cv::Mat render(const RenderSettings& settings, double time_s) {
  return ImageRenderer(RenderFixture::shortCave(), RenderFixture::stereoRig(0.5), settings)
      .render(0, stillView(), time_s);
}

/// Share of the image that differs by more than a few grey values.
double changedShare(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat difference;
  cv::absdiff(a, b, difference);
  return cv::countNonZero(difference > 6) / static_cast<double>(a.total());
}

TEST(MovingWorld, SnowIsCarriedByTheCurrentAsAWhole) {
  RenderSettings settings = RenderSettings::ideal();
  settings.snow.flakes_per_m3 = 800.0;
  settings.snow.median_radius_m = 0.0006;
  settings.lens.blur_sigma_px = 0.0;
  const cv::Mat without = [] { return render(RenderSettings::ideal(), kMiddle_s); }();
  // The water moves by 3 cm in 0.2 s to the left in the image, which is the y axis of the body.
  const Vec3 left_W = stillView()(0.0).rotation * Vec3::UnitY();
  auto current = std::make_shared<DriftTrack>(DriftTrack{0.2, {}});
  for (int i = 0; i < 100; ++i) current->values.push_back(0.03 * i * left_W);
  settings.setCurrent(current);
  const auto flakes = [&](double time_s) {
    cv::Mat image = render(settings, time_s), snow;
    cv::subtract(image, without, snow, cv::noArray(), CV_32F);
    return snow;
  };
  const cv::Mat first = flakes(kMiddle_s), second = flakes(kMiddle_s + 0.2);
  ASSERT_GT(cv::norm(first, cv::NORM_L1), 1000.0);
  // Flakes at different distances move by different amounts: all of them to the left, f * 3 cm / distance.
  double best = -1.0;
  int best_shift = 0;
  for (int shift = -24; shift <= 24; ++shift) {
    const cv::Rect from(30, 0, 260, 240);
    const double match = first(from).dot(second(from + cv::Point(shift, 0)));
    if (match > best) {
      best = match;
      best_shift = shift;
    }
  }
  EXPECT_LE(best_shift, -2);
  EXPECT_GE(best_shift, -20);
}

TEST(MovingWorld, AFishMovesAndCastsAShadow) {
  RenderSettings settings = RenderSettings::ideal();
  const cv::Mat empty = render(settings, kMiddle_s);
  const Rigid3 body = stillView()(0.0);
  FishSchool school;
  school.middle_s = kMiddle_s;
  school.anchor_W = body * Vec3(1.3, 0.1, -0.1);
  school.velocity_W = body.rotation * Vec3(0.0, 0.3, 0.0);
  school.count = 1;
  school.length_m = 0.25;
  settings.fish = {school};
  const cv::Mat now = render(settings, kMiddle_s), later = render(settings, kMiddle_s + 0.5);
  EXPECT_GT(changedShare(empty, now), 0.003);
  EXPECT_LT(changedShare(empty, now), 0.2);
  EXPECT_GT(changedShare(now, later), 0.003);
  EXPECT_EQ(changedShare(empty, render(settings, kMiddle_s + 2.0 * kSchoolLife_s)), 0.0);
}

TEST(MovingWorld, TheBuddysTorchShadesTheWallsAnew) {
  RenderSettings settings = RenderSettings::ideal();
  const cv::Mat alone = render(settings, kMiddle_s);
  auto buddy = std::make_shared<Buddy>();
  const Rigid3 body = stillView()(0.0);
  buddy->world_from_buddy.values = {body * Rigid3(Quat::Identity(), Vec3(3.0, 0.6, 0.1))};
  settings.buddy = buddy;
  const cv::Mat now = render(settings, kMiddle_s), later = render(settings, kMiddle_s + 0.5);
  EXPECT_GT(changedShare(alone, now), 0.02);
  EXPECT_GT(changedShare(now, later), 0.01);
}

TEST(MovingWorld, SaltWaterMovesTheImageThroughAPort) {
  RenderSettings settings = RenderSettings::ideal();
  settings.lens.port = FlatPort{};
  Rig rig = RenderFixture::stereoRig(0.5);
  for (CameraCalibration& camera : rig.cameras) camera = airCameraFor(camera, FlatPort{});
  Halocline halocline;
  halocline.blur_px_per_m = 0.0;
  const auto pointAt = [&](double interface_above_m) {
    halocline.height_W = stillView()(0.0).translation.z() + interface_above_m;
    settings.halocline = halocline;
    const ImageRenderer renderer(RenderFixture::shortCave(), rig, settings);
    return renderer.hitPoint(0, Vec2(300.0, 120.0), stillView()(0.0));
  };
  const auto fresh = pointAt(-3.0), salt = pointAt(3.0);
  ASSERT_TRUE(fresh && salt);
  const Vec3 eye = stillView()(0.0).translation;
  const double turn = std::acos(std::min(1.0, (*fresh - eye).normalized().dot((*salt - eye).normalized())));
  // tan(water angle) of 0.67: d angle = tan(a) dn / n.
  EXPECT_NEAR(turn, 0.67 * 0.0064 / 1.335, 0.0008);
}

}  // namespace
}  // namespace lodeline
