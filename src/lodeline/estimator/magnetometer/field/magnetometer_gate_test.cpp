#include "lodeline/estimator/magnetometer/field/magnetometer_gate.h"

#include <gtest/gtest.h>

#include <functional>
#include <map>

namespace lodeline {
namespace {

using Status = MagnetometerStatus;

FieldCheck headingOff(double error_rad) {
  FieldCheck check;
  check.norm_sigma = 0.005;
  check.dip_sigma_rad = 0.005;
  check.heading_sigma_rad = 0.01;
  check.heading_error_rad = error_rad;
  return check;
}

FieldCheck normOff(double error) {
  FieldCheck check = headingOff(0.0);
  check.norm_error = error;
  return check;
}

FieldCheck dipOff(double error_rad) {
  FieldCheck check = headingOff(0.0);
  check.dip_error_rad = error_rad;
  return check;
}

class MagnetometerGateTest : public testing::Test {
 protected:
  // Runs the gate at 10 Hz and keeps the last decision. The comparison with a disturbance always fits once
  // there is one.
  void run(double seconds, const FieldCheck& earth, const FieldCheck& disturbed = headingOff(0.0)) {
    for (int i = 0; i < static_cast<int>(10.0 * seconds); ++i) {
      time_s_ += 0.1;
      last_ = gate_.decide(Time::fromSeconds(time_s_), earth,
                           disturbance_ ? std::optional<FieldCheck>(disturbed) : std::nullopt);
      ++count_[last_.status];
      begun_ += last_.begin_disturbance;
      ended_ += last_.end_disturbance;
      disturbance_ = last_.begin_disturbance || (disturbance_ && !last_.end_disturbance);
    }
  }

  MagnetometerGate gate_{MagnetometerGateOptions()};
  double time_s_ = 0.0;
  GateDecision last_;
  std::map<Status, int> count_;
  bool disturbance_ = false;
  int begun_ = 0, ended_ = 0;
};

TEST_F(MagnetometerGateTest, UsesWhatFits) {
  run(100.0, headingOff(0.01));
  EXPECT_EQ(count_[Status::Used], 1000);
  EXPECT_DOUBLE_EQ(last_.variance_scale, 1.0);
}

TEST_F(MagnetometerGateTest, NamesWhatIsWrong) {
  run(0.1, normOff(0.05));
  EXPECT_EQ(last_.status, Status::Norm);
  EXPECT_FALSE(last_.use);
  run(5.0, headingOff(0.0));
  run(0.1, dipOff(-0.1));
  EXPECT_EQ(last_.status, Status::Dip);
  run(5.0, headingOff(0.0));
  run(0.1, headingOff(-0.04));
  EXPECT_EQ(last_.status, Status::Innovation);
}

TEST_F(MagnetometerGateTest, WidensItsLimitsWithTheUncertainty) {
  FieldCheck check = normOff(0.1);
  check.norm_sigma = 0.05;
  run(0.1, check);
  EXPECT_EQ(last_.status, Status::Used);
  check = headingOff(0.2);
  check.heading_sigma_rad = 0.1;
  run(0.1, check);
  EXPECT_EQ(last_.status, Status::Used);
}

TEST_F(MagnetometerGateTest, LowersTheWeightBeforeItRejects) {
  run(0.1, headingOff(0.0149));
  EXPECT_DOUBLE_EQ(last_.variance_scale, 1.0);
  run(0.1, headingOff(0.0299));
  EXPECT_TRUE(last_.use);
  EXPECT_NEAR(last_.variance_scale, 4.0, 0.1);
}

TEST_F(MagnetometerGateTest, WeighsLittleWhatItRejectedForLong) {
  run(40.0, normOff(0.1));
  run(5.0, headingOff(0.0));
  ASSERT_TRUE(last_.use);
  EXPECT_GT(last_.variance_scale, 10.0);
  run(20.0, normOff(0.1));
  run(5.0, headingOff(0.0));
  const double twice = last_.variance_scale;
  EXPECT_GT(twice, 15.0);
  run(240.0, headingOff(0.0));
  EXPECT_NEAR(last_.variance_scale, 1.0, 0.1);
}

TEST_F(MagnetometerGateTest, ReleasesOnlyWhatStaysWellWithinTheLimits) {
  run(5.0, headingOff(0.1));
  run(20.0, headingOff(0.025));  // within the limit, but not within the share for release
  EXPECT_EQ(last_.status, Status::Innovation);
  run(3.8, headingOff(0.01));
  EXPECT_FALSE(last_.use) << "not yet";
  run(0.1, headingOff(0.1));
  run(3.8, headingOff(0.01));
  EXPECT_FALSE(last_.use) << "the time counts afresh";
  run(0.4, headingOff(0.01));
  EXPECT_EQ(last_.status, Status::Used);
  EXPECT_EQ(begun_, 0);
}

TEST_F(MagnetometerGateTest, ReadmitsAfterAMinuteAsADisturbedField) {
  run(0.1, headingOff(0.1));
  run(59.9, headingOff(0.1));
  EXPECT_FALSE(last_.use);
  run(0.2, headingOff(0.1));
  EXPECT_EQ(last_.status, Status::Readmitted);
  EXPECT_TRUE(last_.use);
  EXPECT_EQ(begun_, 1);
  run(300.0, headingOff(0.1));
  EXPECT_EQ(last_.status, Status::Readmitted);
  EXPECT_EQ(begun_, 1) << "once is enough";
}

TEST_F(MagnetometerGateTest, EndsTheDisturbanceWhenTheEarthsFieldIsBack) {
  run(70.0, headingOff(0.1));
  ASSERT_EQ(last_.status, Status::Readmitted);
  // The disturbance ends: first neither field fits, then the Earth's does.
  run(2.0, headingOff(0.05), headingOff(-0.05));
  EXPECT_EQ(last_.status, Status::Innovation);
  run(5.0, headingOff(0.0), headingOff(-0.1));
  EXPECT_EQ(last_.status, Status::Used);
  EXPECT_EQ(ended_, 1);
  EXPECT_FALSE(disturbance_);
}

TEST_F(MagnetometerGateTest, BeginsAnotherDisturbanceWhenTheFirstHasChanged) {
  run(120.0, headingOff(0.0));
  run(70.0, headingOff(0.1));
  for (int i = 0; i < 700 && begun_ < 2; ++i) run(0.1, normOff(0.1), normOff(0.1));
  EXPECT_EQ(last_.status, Status::Readmitted);
  EXPECT_EQ(begun_, 2);
  // A disturbance that only paused is used again.
  run(5.0, normOff(0.1), normOff(0.1));
  run(5.0, normOff(0.1), headingOff(0.0));
  EXPECT_EQ(last_.status, Status::Readmitted);
  EXPECT_EQ(begun_, 2);
}

TEST_F(MagnetometerGateTest, BelievesNothingOfWhatDisagreesForLongerThanItAgrees) {
  // Alternately a minute of agreement and more than a minute of disagreement, as when a rig with a wrong
  // calibration turns.
  run(30.0, headingOff(0.0));
  for (int i = 0; i < 6; ++i) {
    run(50.0, normOff(0.1), normOff(0.1));
    run(20.0, headingOff(0.0), normOff(0.1));
  }
  EXPECT_EQ(last_.status, Status::Inconsistent);
  EXPECT_FALSE(last_.use) << "it fits, but it did so before";
  EXPECT_EQ(begun_, 0);
  count_.clear();
  run(400.0, headingOff(0.0));
  EXPECT_EQ(last_.status, Status::Used) << "agreement has prevailed";
  EXPECT_GT(count_[Status::Inconsistent], 500);
}

TEST_F(MagnetometerGateTest, BelievesNothingOfWhatFitsOnlyHalfOfTheTime) {
  for (int i = 0; i < 6; ++i) {
    run(40.0, headingOff(0.0));
    run(45.0, normOff(0.1), normOff(0.1));
  }
  EXPECT_EQ(last_.status, Status::Inconsistent);
}

TEST_F(MagnetometerGateTest, BelievesASensorThatIsDisturbedAQuarterOfTheTime) {
  for (int i = 0; i < 20; ++i) {
    run(60.0, headingOff(0.0));
    run(15.0, normOff(0.1), normOff(0.1));
  }
  EXPECT_EQ(count_[Status::Inconsistent], 0);
}

TEST_F(MagnetometerGateTest, BelievesNothingOfAFieldThatNeverAgreesWell) {
  FieldCheck poor = headingOff(0.01);
  poor.correlated_sigma_rad = 0.03;
  run(10.0, poor);
  EXPECT_EQ(last_.status, Status::Inconsistent);
  // The release needs both agreement and a small time-correlated error.
  run(200.0, poor);
  EXPECT_EQ(last_.status, Status::Inconsistent);
  run(5.0, headingOff(0.01));
  EXPECT_EQ(last_.status, Status::Used);
}

TEST_F(MagnetometerGateTest, EndsTheDisturbanceOfASensorThatItDistrusts) {
  run(70.0, headingOff(0.1));
  ASSERT_TRUE(disturbance_);
  run(100.0, headingOff(0.1), normOff(0.1));
  EXPECT_EQ(last_.status, Status::Inconsistent);
  EXPECT_FALSE(disturbance_);
  EXPECT_EQ(ended_, 1);
}

TEST_F(MagnetometerGateTest, TriesADistrustedSensorAgainInTheEnd) {
  run(30.0, headingOff(0.0));
  run(200.0, normOff(0.1), normOff(0.1));
  ASSERT_EQ(last_.status, Status::Inconsistent);
  const int begun = begun_;
  run(1900.0, normOff(0.1), headingOff(0.0));
  EXPECT_EQ(begun_, begun + 1);
  EXPECT_EQ(last_.status, Status::Readmitted);
}

TEST_F(MagnetometerGateTest, ForgivesALongDisturbanceToASensorThatWasGood) {
  run(400.0, headingOff(0.0));
  run(270.0, normOff(0.1));
  EXPECT_EQ(count_[Status::Inconsistent], 0);
  run(5.0, headingOff(0.0));
  EXPECT_EQ(last_.status, Status::Used);
}

TEST(MagnetometerStatusNames, AreDistinct) {
  std::map<std::string, int> names;
  for (int i = 0; i <= static_cast<int>(Status::Uncalibrated); ++i) ++names[toString(static_cast<Status>(i))];
  EXPECT_EQ(names.size(), 9u);
  EXPECT_EQ(names.count("unknown"), 0u);
}

}  // namespace
}  // namespace lodeline
