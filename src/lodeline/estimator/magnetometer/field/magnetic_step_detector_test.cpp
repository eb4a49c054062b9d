#include "lodeline/estimator/magnetometer/field/magnetic_step_detector.h"

#include <gtest/gtest.h>

#include <functional>
#include <random>

namespace lodeline {
namespace {

constexpr double kWhite_T = 0.04e-6;  // noise of a frame's mean
const Vec3 kLamp_B(0.06e-6, -0.15e-6, 0.1e-6);

/// Detector on a field whose difference from the expected one follows `difference_B`, with white noise.
class MagneticStepDetectorTest : public testing::Test {
 protected:
  void follow(double duration_s, const std::function<Vec3(double t_s)>& difference_B, double rate_hz = 15.0) {
    for (double end_s = time_s_ + duration_s; time_s_ < end_s; time_s_ += 1.0 / rate_hz) {
      reading_.time = Time::fromSeconds(time_s_);
      reading_.difference_B = difference_B(time_s_) + kWhite_T * Vec3(noise(), noise(), noise());
      reading_.white_variance_T2 = kWhite_T * kWhite_T;
      const auto change = step_.add(reading_);
      if (!change) continue;
      ++changes_;
      changed_s_ = time_s_;
      sigma_T_ = change->sigma_T;
    }
  }
  void run(double duration_s, const Vec3& difference_B, double rate_hz = 15.0) {
    follow(
        duration_s, [&](double) { return difference_B; }, rate_hz);
  }
  double noise() { return normal_(engine_); }

  MagneticStepDetector step_{MagneticStepDetectorOptions()};
  MagneticStepDetector::Reading reading_;
  double time_s_ = 0.0, changed_s_ = 0.0, sigma_T_ = 0.0;
  int changes_ = 0;

 private:
  std::mt19937_64 engine_{1};
  std::normal_distribution<double> normal_{0.0, 1.0};
};

TEST_F(MagneticStepDetectorTest, FindsACurrentThatIsSwitchedOnAndOff) {
  const Vec3 before_B(0.1e-6, 0.05e-6, -0.1e-6);  // residual hard iron
  run(60.0, before_B);
  EXPECT_EQ(changes_, 0);
  run(60.0, before_B + kLamp_B);
  ASSERT_EQ(changes_, 1);
  EXPECT_NEAR(changed_s_, 61.5, 0.5);
  EXPECT_LT((step_.step_B() - kLamp_B).norm(), 3.0 * sigma_T_);
  EXPECT_LT(sigma_T_, 0.2 * kLamp_B.norm());
  run(60.0, before_B);
  EXPECT_EQ(changes_, 2);
  EXPECT_TRUE(step_.step_B().isZero()) << "what is left of two opposite steps is noise";
}

TEST_F(MagneticStepDetectorTest, FindsItAtFourFramesASecond) {
  run(60.0, Vec3::Zero(), 4.0);
  run(20.0, 2.0 * kLamp_B, 4.0);
  EXPECT_EQ(changes_, 1);
  EXPECT_LT((step_.step_B() - 2.0 * kLamp_B).norm(), 3.0 * sigma_T_);
}

TEST_F(MagneticStepDetectorTest, KnowsSeveralLevels) {
  run(60.0, Vec3::Zero());
  run(30.0, kLamp_B);
  run(30.0, 3.0 * kLamp_B);
  EXPECT_EQ(changes_, 2);
  EXPECT_LT((step_.step_B() - 3.0 * kLamp_B).norm(), 0.3 * kLamp_B.norm());
}

TEST_F(MagneticStepDetectorTest, FindsNothingInNoise) {
  run(3600.0, Vec3::Zero());
  EXPECT_EQ(changes_, 0);
}

TEST_F(MagneticStepDetectorTest, FindsNothingInWhatComesAndGoesOverSeconds) {
  run(60.0, Vec3::Zero());
  follow(120.0, [](double t_s) { return Vec3(10.0 * kLamp_B * std::sin((t_s - 60.0) / 3.0)); });
  EXPECT_EQ(changes_, 0);
}

TEST_F(MagneticStepDetectorTest, LeavesWhatShowsInHeadingAlone) {
  run(60.0, Vec3::Zero());
  reading_.heading_B = kLamp_B.normalized();
  run(30.0, 2.0 * kLamp_B);
  EXPECT_EQ(changes_, 0);
}

TEST_F(MagneticStepDetectorTest, LeavesAFieldThatWasNotTheEarthsBefore) {
  const Vec3 tank_B(3e-6, 0.0, 1e-6);
  run(60.0, Vec3::Zero());
  reading_.is_believed = false;
  follow(5.0, [&](double t_s) { return Vec3((t_s - 60.0) / 5.0 * tank_B); });
  run(20.0, tank_B);
  run(10.0, tank_B + 2.0 * kLamp_B);
  EXPECT_EQ(changes_, 0);
}

TEST_F(MagneticStepDetectorTest, DropsAStepWhoseEndWasMissed) {
  run(60.0, Vec3::Zero());
  run(30.0, kLamp_B);
  ASSERT_EQ(changes_, 1);
  follow(20.0, [](double t_s) { return Vec3(std::max(0.0, 1.0 - (t_s - 90.0) / 15.0) * kLamp_B); });
  run(20.0, Vec3::Zero());
  EXPECT_EQ(changes_, 2);
  EXPECT_TRUE(step_.step_B().isZero());
}

// The start of a known lamp comes in slowly and is missed; its end is no current in the other direction.
TEST_F(MagneticStepDetectorTest, KnowsTheEndOfAMissedStart) {
  run(60.0, Vec3::Zero());
  run(30.0, 2.0 * kLamp_B);
  run(30.0, Vec3::Zero());
  ASSERT_EQ(changes_, 2);
  follow(20.0, [](double t_s) { return Vec3(std::min(1.0, (t_s - 120.0) / 15.0) * 2.0 * kLamp_B); });
  run(60.0, 2.0 * kLamp_B);
  ASSERT_EQ(changes_, 2);
  run(30.0, Vec3::Zero());
  EXPECT_EQ(changes_, 2);
  EXPECT_TRUE(step_.step_B().isZero());
}

// One lamp, switched six times: one channel, whose field becomes better known each time.
TEST_F(MagneticStepDetectorTest, LearnsALampThatIsSwitchedAgain) {
  run(60.0, Vec3::Zero());
  double first_sigma_T = 0.0;
  for (int i = 0; i < 6; ++i) {
    run(30.0, 2.0 * kLamp_B);
    EXPECT_EQ(changes_, 2 * i + 1);
    if (i == 0) first_sigma_T = sigma_T_;
    EXPECT_LT((step_.step_B() - 2.0 * kLamp_B).norm(), 3.0 * first_sigma_T);
    run(30.0, Vec3::Zero());
    EXPECT_EQ(changes_, 2 * i + 2);
    EXPECT_TRUE(step_.step_B().isZero());
  }
  EXPECT_EQ(step_.channels(), 1u);
  EXPECT_LT(sigma_T_, 0.5 * first_sigma_T);
  run(30.0, 2.0 * kLamp_B);
  EXPECT_LT((step_.step_B() - 2.0 * kLamp_B).norm(), 0.1 * kLamp_B.norm());
}

TEST_F(MagneticStepDetectorTest, KeepsTwoLampsApart) {
  const Vec3 other_B(0.2e-6, 0.1e-6, 0.05e-6);
  run(60.0, Vec3::Zero());
  for (int i = 0; i < 2; ++i) {
    run(20.0, 2.0 * kLamp_B);
    run(20.0, 2.0 * kLamp_B + other_B);
    EXPECT_LT((step_.step_B() - 2.0 * kLamp_B - other_B).norm(), 0.1e-6);
    run(20.0, other_B);  // the first one is switched off first
    EXPECT_LT((step_.step_B() - other_B).norm(), 0.06e-6);
    run(20.0, Vec3::Zero());
    EXPECT_TRUE(step_.step_B().isZero());
  }
  EXPECT_EQ(step_.channels(), 2u);
  EXPECT_EQ(changes_, 8);
}

// A known lamp is found where a new one is not: where its field shows along the heading for the most part.
TEST_F(MagneticStepDetectorTest, KnowsALampAlsoWhereItShowsInHeading) {
  run(60.0, Vec3::Zero());
  reading_.heading_B = (Vec3(-0.15, -0.06, 0.0)).normalized();
  run(30.0, 4.0 * kLamp_B);
  run(30.0, Vec3::Zero());
  ASSERT_EQ(changes_, 2);
  reading_.heading_B = (kLamp_B + 0.2 * kLamp_B.norm() * reading_.heading_B).normalized();
  run(30.0, 4.0 * kLamp_B);
  EXPECT_EQ(changes_, 3);
  MagneticStepDetector unknowing{MagneticStepDetectorOptions()};
  std::swap(step_, unknowing);
  run(60.0, Vec3::Zero());
  changes_ = 0;
  run(30.0, 4.0 * kLamp_B);
  EXPECT_EQ(changes_, 0) << "it may be a correction of the heading";
}

TEST_F(MagneticStepDetectorTest, FindsNoLampInNoiseAfterOneWasLearnt) {
  run(60.0, Vec3::Zero());
  run(30.0, kLamp_B);
  run(30.0, Vec3::Zero());
  ASSERT_EQ(changes_, 2);
  run(3600.0, Vec3::Zero());
  EXPECT_EQ(changes_, 2);
}

TEST_F(MagneticStepDetectorTest, WaitsUntilTheStartHasSettled) {
  run(5.0, Vec3::Zero());
  run(10.0, kLamp_B);
  EXPECT_EQ(changes_, 0);
}

}  // namespace
}  // namespace lodeline
