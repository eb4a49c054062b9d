#include "lodeline/inspection/plausibility/odd_intrinsics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lodeline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

/// The first camera of EuRoC's rig, with other numbers.
CameraCalibration camera(double fx_px, double fy_px, double cx_px, double cy_px) {
  CameraCalibration camera;
  camera.width_px = 752;
  camera.height_px = 480;
  camera.fx_px = fx_px;
  camera.fy_px = fy_px;
  camera.cx_px = cx_px;
  camera.cy_px = cy_px;
  return camera;
}

TEST(OddIntrinsics, AreNotThoseOfARealCamera) {
  EXPECT_THAT(oddIntrinsics(camera(458.654, 457.296, 367.215, 248.375)).words, IsEmpty());
  EXPECT_THAT(oddIntrinsics(camera(190.0, 190.0, 330.0, 270.0)).words, IsEmpty());    // wide, off the centre
  EXPECT_THAT(oddIntrinsics(camera(1500.0, 1500.0, 376.0, 240.0)).words, IsEmpty());  // narrow
  EXPECT_THAT(oddIntrinsics(CameraCalibration()).words, IsEmpty());
}

TEST(OddIntrinsics, InAnotherOrderAreNamedWithTheOrder) {
  const auto expectOrder = [](const CameraCalibration& given, const char* order) {
    const OddIntrinsics odd = oddIntrinsics(given);
    EXPECT_TRUE(odd.is_explained) << order;
    EXPECT_THAT(odd.words,
                AllOf(HasSubstr(std::string("as ") + order + " they fit"), HasSubstr("752 x 480")));
  };
  expectOrder(camera(367.215, 248.375, 458.654, 457.296), "cx, cy, fx, fy");
  expectOrder(camera(458.654, 367.215, 457.296, 248.375), "fx, cx, fy, cy");
  expectOrder(camera(458.654, 457.296, 248.375, 367.215), "fx, fy, cy, cx");
}

TEST(OddIntrinsics, OfAnotherImageSizeAreNamedWithTheFactor) {
  const OddIntrinsics half = oddIntrinsics(camera(229.3, 228.6, 183.6, 124.2));
  EXPECT_TRUE(half.is_explained);
  EXPECT_THAT(half.words, AllOf(HasSubstr("(184, 124) px is the centre of images of 378 x 241 px"),
                                HasSubstr("multiply fx, fy, cx and cy by 1.99")));
  EXPECT_THAT(oddIntrinsics(camera(687.9, 685.9, 550.8, 372.6)).words, HasSubstr("by 0.663"));
}

TEST(OddIntrinsics, WithRadialCoefficientsInThePlaceOfTangentialOnesAreNamed) {
  CameraCalibration lens = camera(458.654, 457.296, 367.215, 248.375);
  lens.model = "radial-tangential";
  lens.distortion = {-0.2834, 0.0740, 0.0002, 0.00002, -0.01};
  EXPECT_THAT(oddIntrinsics(lens).words, IsEmpty());
  lens.distortion = {-0.2834, 0.0740, -0.031, 0.0002, 0.00002};  // k1, k2, k3, p1, p2
  EXPECT_THAT(oddIntrinsics(lens).words,
              AllOf(HasSubstr("p1 = -0.031"), HasSubstr("in the order k1, k2, p1, p2, k3?")));
}

TEST(OddIntrinsics, WithoutACauseAreNamed) {
  const OddIntrinsics odd = oddIntrinsics(camera(458.0, 457.0, 600.0, 230.0));
  EXPECT_FALSE(odd.is_explained);
  EXPECT_THAT(odd.words, HasSubstr("far from the centre"));
  EXPECT_THAT(oddIntrinsics(camera(458.0, 380.0, 370.0, 240.0)).words, HasSubstr("pixels are square"));
}

}  // namespace
}  // namespace lodeline
