#include "lodeline/estimator/magnetometer/field/field_innovation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/estimator/magnetometer/field/magnetometer_states.h"
#include "lodeline/geometry/so3.h"
#include "simulation/shared/random.h"

namespace lodeline {
namespace {

const Vec3 kField_W(0.0, 24e-6, -38e-6);

class FieldInnovationTest : public testing::Test {
 protected:
  FieldInnovationTest() {
    const auto add = [&](const char* name, const Vec3& value) {
      window_.add({name, {value.x(), value.y(), value.z()}, std::nullopt, 0.0});
    };
    add(MagnetometerStates::kField, kField_W);
    add(MagnetometerStates::kOffset, offset_B_);
    add(MagnetometerStates::kDisturbance, disturbance_W_);
    for (int k = 0; k < 2; ++k) window_.add(std::make_unique<Frame>());
  }

  /// Reads `field_W` by a body that turns, with noise of `sigma_T` per axis.
  FieldCheck see(double time_s, const Vec3& field_W, double sigma_T, bool disturbed = false) {
    NavigationState state;
    state.time = Time::fromSeconds(time_s);
    state.world_from_body.rotation = so3::exp(Vec3(0.1, 0.3, 0.7 * time_s));
    window_.newest().setState(state);
    MagnetometerMean mean;
    mean.time = state.time;
    mean.field_B = state.world_from_body.rotation.conjugate() * field_W + offset_B_;
    if (sigma_T > 0.0) mean.field_B += sigma_T * random_.normal3();
    mean.readings = 1;
    comparison_.add(mean, sigma_T * sigma_T, window_);
    return comparison_.check(window_, JointCovariance(), 0.0, disturbed);
  }

  const Vec3 offset_B_{1e-6, -2e-6, 3e-6};
  const Vec3 disturbance_W_{3e-6, 0.0, 0.0};
  MagnetometerOptions options_;
  Window window_;
  FieldInnovation comparison_{options_};
  Random random_{1, "field comparison"};
};

TEST_F(FieldInnovationTest, TellsHeadingDipAndSizeApart) {
  const double angle = 0.02;
  FieldCheck check = see(1.0, kField_W, 0.0);
  EXPECT_NEAR(check.heading_error_rad, 0.0, 1e-9);
  EXPECT_NEAR(check.norm_error, 0.0, 1e-9);
  check = see(1.1, so3::exp(Vec3(0.0, 0.0, angle)) * kField_W, 0.0);
  EXPECT_NEAR(std::abs(check.heading_error_rad), angle, 1e-6);
  EXPECT_NEAR(check.dip_error_rad, 0.0, 1e-9);
  check = see(1.2, so3::exp(Vec3(angle, 0.0, 0.0)) * kField_W, 0.0);
  EXPECT_NEAR(std::abs(check.dip_error_rad), angle, 1e-6);
  EXPECT_NEAR(check.heading_error_rad, 0.0, 1e-9);
  check = see(1.3, 1.03 * kField_W, 0.0);
  EXPECT_NEAR(check.norm_error, 0.03, 1e-9);
  check = see(1.4, kField_W + disturbance_W_, 0.0, true);
  EXPECT_NEAR(check.heading_error_rad, 0.0, 1e-9);
}

TEST_F(FieldInnovationTest, HearsASensorOfLittleNoiseAtOnce) {
  const double sigma_T = 0.5 * options_.gate.field_sigma_T;
  for (int k = 0; k < 20; ++k) see(0.1 * k, kField_W, sigma_T);
  EXPECT_DOUBLE_EQ(comparison_.whiteVariance(), sigma_T * sigma_T);
  EXPECT_NEAR(see(2.0, 1.1 * kField_W, 1e-12).norm_error, 0.1, 1e-6);
}

TEST_F(FieldInnovationTest, AveragesTheNoiseOfAPoorOneAndKnowsHowMuchIsLeft) {
  const double sigma_T = 0.6e-6;
  const int settling = 200, frames = 20000;
  double squares = 0.0;
  for (int k = 0; k < settling + frames; ++k) {
    const FieldCheck check = see(0.1 * k, kField_W, sigma_T);
    if (k >= settling) squares += std::pow(check.heading_error_rad * kField_W.head<2>().norm(), 2);
  }
  const double left_T2 = comparison_.whiteVariance();
  EXPECT_NEAR(std::sqrt(left_T2), options_.gate.field_sigma_T, 0.05 * options_.gate.field_sigma_T);
  EXPECT_NEAR(squares / frames, left_T2, 0.1 * left_T2);
}

TEST_F(FieldInnovationTest, DoesNotAverageOverAGap) {
  const double sigma_T = 0.6e-6;
  for (int k = 0; k < 100; ++k) see(0.1 * k, kField_W, sigma_T);
  EXPECT_LT(comparison_.whiteVariance(), 0.1 * sigma_T * sigma_T);
  see(20.0, kField_W, sigma_T);
  EXPECT_DOUBLE_EQ(comparison_.whiteVariance(), sigma_T * sigma_T);
}

}  // namespace
}  // namespace lodeline
