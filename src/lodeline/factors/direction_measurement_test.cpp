#include "lodeline/factors/direction_measurement.h"

#include <gtest/gtest.h>

#include <numbers>

#include "lodeline/factors/reprojection_scene.h"

namespace lodeline {
namespace {

Vec2 towards(int direction, int of) {
  const double angle = 2.0 * std::numbers::pi * direction / of;
  return {std::cos(angle), std::sin(angle)};
}

class ResidualThroughALens : public testing::TestWithParam<std::string> {
 protected:
  std::shared_ptr<const Camera> camera_ = makeCamera(withModel(GetParam()));
  Vec3 towards_the_corner_C_ = *camera_->unproject(Vec2(60.0, 40.0));
};

// Pixel noise is symmetric about the true pixel.
TEST_P(ResidualThroughALens, HasNoMeanWhereNoiseHasNone) {
  constexpr double kSigma_px = 0.5, kNoise_px = 1.0;
  const Vec2 pixel = *camera_->project(towards_the_corner_C_);
  Vec2 mean = Vec2::Zero(), to_first_order = Vec2::Zero();
  constexpr int kDirections = 8;
  for (int i = 0; i < kDirections; ++i) {
    const Vec2 noise = kNoise_px * towards(i, kDirections);
    const Vec3 seen_C = *camera_->unproject(pixel + noise);
    DirectionMeasurement measurement = DirectionMeasurement::fromBearing(*camera_, seen_C, kSigma_px);
    mean += directionResidual(measurement, towards_the_corner_C_, nullptr) / kDirections;
    measurement.curvature.setZero();
    to_first_order += directionResidual(measurement, towards_the_corner_C_, nullptr) / kDirections;
  }
  EXPECT_GT(to_first_order.norm(), 3e-4) << "too easy a lens";
  EXPECT_LT(mean.norm(), 0.005 * to_first_order.norm()) << "the fourth order";
}

TEST_P(ResidualThroughALens, IsThePixelErrorToSecondOrder) {
  const Vec2 corner(60.0, 40.0), between(500.0, 300.0), centre(367.0, 248.0);
  for (const Vec2& pixel : {corner, between, centre}) {
    const DirectionMeasurement measurement =
        DirectionMeasurement::fromBearing(*camera_, *camera_->unproject(pixel), 1.0);
    for (const double error_px : {1.0, 4.0, 16.0}) {
      const Vec2 error(0.6 * error_px, -0.8 * error_px);
      const Vec3 point_C = 3.0 * *camera_->unproject(pixel + error);
      // The remaining error is of third order; a pixel is two thousandths of a radian.
      EXPECT_LT((directionResidual(measurement, point_C, nullptr) - error).norm(),
                5e-6 * std::pow(error_px, 3))
          << pixel.transpose();
    }
  }
}

TEST_P(ResidualThroughALens, HasItsDerivativeNearAndFar) {
  constexpr double kStep = 1e-6;
  const DirectionMeasurement measurement =
      DirectionMeasurement::fromBearing(*camera_, towards_the_corner_C_, 0.7);
  for (const double offset : {0.0, 0.01, 0.1, 1.0}) {
    const Vec3 point_C = 2.0 * (towards_the_corner_C_ + measurement.tangent_C * Vec2(0.8, -0.6) * offset);
    Mat23 by_point;
    directionResidual(measurement, point_C, &by_point);
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 step = kStep * Vec3::Unit(axis);
      const Vec2 difference = directionResidual(measurement, point_C + step, nullptr) -
                              directionResidual(measurement, point_C - step, nullptr);
      EXPECT_LT((by_point.col(axis) - difference / (2.0 * kStep)).norm(), 1e-5 * by_point.norm()) << offset;
    }
  }
}

// Far from the measured ray the second order does not describe the projection. It must neither reverse a
// residual nor make it small.
TEST_P(ResidualThroughALens, GrowsOutwardsHoweverFarOff) {
  const DirectionMeasurement measurement =
      DirectionMeasurement::fromBearing(*camera_, towards_the_corner_C_, 1.0);
  constexpr int kDirections = 16;
  for (int i = 0; i < kDirections; ++i) {
    double before = 0.0;
    for (double offset = 0.01; offset < 3.0; offset *= 1.3) {
      const Vec3 point_C = towards_the_corner_C_ + measurement.tangent_C * towards(i, kDirections) * offset;
      const double error = directionResidual(measurement, point_C, nullptr).norm();
      EXPECT_GT(error, 1.1 * before) << offset;
      before = error;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Models, ResidualThroughALens, testing::ValuesIn(modelNames()), modelTestName);

}  // namespace
}  // namespace lodeline
