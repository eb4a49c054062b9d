#include "lodeline/estimator/magnetometer/field/magnetic_noise_estimator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

const Vec3 kQuietField_W(0.0, 24e-6, -38e-6);

struct Conditions {
  double correlated_noise_sigma_T = 0.0;  ///< size of an error whose correlation falls to 1/e in 5 s
  double walk_T_per_sqrt_s = 0.0;
  double white_sigma_T = 0.01e-6;
  double tilt_sigma_rad = 0.0;  ///< of the orientation given to the estimator, with the same correlation time
  double minutes = 30.0;
  Vec3 offset_B = Vec3::Zero();  ///< initial value of the walk
};

// A rig that looks around like a diver, with readings at 4 Hz.
class MagneticNoiseEstimatorTest : public testing::Test {
 protected:
  MagneticNoiseEstimator errors_{MagnetometerOptions(), 0.15e-6};

  void dive(const Conditions& conditions, uint32_t seed) {
    std::mt19937 engine(seed);
    std::normal_distribution<double> normal;
    const auto draw = [&](double sigma) -> Vec3 {
      return sigma * Vec3(normal(engine), normal(engine), normal(engine));
    };
    Vec3 offset_B = conditions.offset_B, floor_W = draw(conditions.correlated_noise_sigma_T),
         tilt = draw(conditions.tilt_sigma_rad);
    const double step_s = 0.25, correlation_s = 5.0;
    const double kept = std::exp(-step_s / correlation_s), fresh = std::sqrt(1.0 - kept * kept);
    for (int i = 0; i < static_cast<int>(conditions.minutes * 60.0 / step_s); ++i) {
      time_s_ += step_s;
      floor_W = kept * floor_W + draw(fresh * conditions.correlated_noise_sigma_T);
      tilt = kept * tilt + draw(fresh * conditions.tilt_sigma_rad);
      offset_B += draw(conditions.walk_T_per_sqrt_s * std::sqrt(step_s));
      const Quat world_from_body =
          so3::exp(Vec3(0.0, 0.0, 0.05 * time_s_)) *
          so3::exp(Vec3(0.3 * std::sin(0.11 * time_s_), 0.2 * std::sin(0.17 * time_s_), 0.0));
      MagnetometerMean mean;
      mean.time = Time::fromSeconds(time_s_);
      mean.field_B =
          world_from_body.conjugate() * (kQuietField_W + floor_W) + offset_B + draw(conditions.white_sigma_T);
      mean.readings = 1;
      errors_.add(mean, so3::exp(Vec3(tilt.x(), tilt.y(), 0.0)) * world_from_body, Vec3::Zero(),
                  std::pow(conditions.white_sigma_T, 2),
                  {std::pow(conditions.tilt_sigma_rad, 2), correlation_s});
    }
  }

 private:
  double time_s_ = 0.0;
};

TEST_F(MagneticNoiseEstimatorTest, StartFromWhatIsUsual) {
  const MagnetometerOptions options;
  EXPECT_NEAR(errors_.correlated_noise_sigma_T(), options.correlated_noise_sigma_T,
              0.1 * options.correlated_noise_sigma_T);
  EXPECT_NEAR(errors_.walk_T_per_sqrt_s(), options.offset_walk_T_per_sqrt_s,
              0.2 * options.offset_walk_T_per_sqrt_s);
}

TEST_F(MagneticNoiseEstimatorTest, FindTheFloorUnderNoise) {
  for (const double correlated_noise_sigma_T : {0.02e-6, 0.1e-6, 0.5e-6}) {
    errors_ = MagneticNoiseEstimator(MagnetometerOptions(), 0.15e-6);
    dive({.correlated_noise_sigma_T = correlated_noise_sigma_T,
          .white_sigma_T = 0.3 * correlated_noise_sigma_T},
         1);
    EXPECT_NEAR(errors_.correlated_noise_sigma_T(), correlated_noise_sigma_T, 0.3 * correlated_noise_sigma_T);
  }
}

TEST_F(MagneticNoiseEstimatorTest, FindThatThereIsNone) {
  dive({}, 2);
  EXPECT_LT(errors_.correlated_noise_sigma_T(), 0.006e-6);
  EXPECT_LT(errors_.walk_T_per_sqrt_s(), 0.3e-9);
}

TEST_F(MagneticNoiseEstimatorTest, TakeALastingOffsetForNeither) {
  dive({.offset_B = Vec3(0.2e-6, -0.1e-6, 0.15e-6)}, 3);
  EXPECT_LT(errors_.correlated_noise_sigma_T(), 0.006e-6);
  EXPECT_LT(errors_.walk_T_per_sqrt_s(), 0.3e-9);
}

TEST_F(MagneticNoiseEstimatorTest, TellAWalkFromAFloor) {
  dive({.correlated_noise_sigma_T = 0.02e-6, .walk_T_per_sqrt_s = 2.5e-9}, 4);
  EXPECT_NEAR(errors_.correlated_noise_sigma_T(), 0.02e-6, 0.008e-6);
  EXPECT_NEAR(errors_.walk_T_per_sqrt_s(), 2.5e-9, 1e-9);
}

TEST_F(MagneticNoiseEstimatorTest, LearnLittleWhereTheTiltIsTheDoubt) {
  // 1 degree is 0.8 uT across the field. The size of the field does not depend on the tilt and remains
  // informative.
  dive({.correlated_noise_sigma_T = 0.05e-6, .tilt_sigma_rad = 0.0175}, 5);
  EXPECT_NEAR(errors_.correlated_noise_sigma_T(), 0.05e-6, 0.02e-6);
}

TEST_F(MagneticNoiseEstimatorTest, ForgetWhatIsLongOver) {
  dive({.correlated_noise_sigma_T = 0.5e-6, .minutes = 5.0}, 6);
  const double disturbed_T = errors_.correlated_noise_sigma_T();
  EXPECT_GT(disturbed_T, 0.3e-6);
  dive({.minutes = 30.0}, 7);
  EXPECT_LT(errors_.correlated_noise_sigma_T(), 0.1 * disturbed_T);
}

TEST_F(MagneticNoiseEstimatorTest, AreNumbersAtAMagneticPole) {
  MagnetometerMean mean;
  mean.field_B = Vec3(0.0, 0.0, -6e-5);
  mean.readings = 1;
  for (int i = 0; i < 100; ++i) {
    mean.time = Time::fromSeconds(i);
    errors_.add(mean, Quat::Identity(), Vec3::Zero(), 1e-16, {1e-6, 5.0});
  }
  EXPECT_GT(errors_.correlated_noise_sigma_T(), 0.0);
  EXPECT_GT(errors_.walk_T_per_sqrt_s(), 0.0);
}

}  // namespace
}  // namespace lodeline
