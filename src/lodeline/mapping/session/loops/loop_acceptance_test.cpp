#include "lodeline/mapping/session/loops/loop_acceptance.h"

#include <gtest/gtest.h>

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

/// Forty keyframes on a straight way of 20 m, swum twice; the second lap has the numbers 100 and up.
class LoopAcceptanceTest : public testing::Test {
 protected:
  LoopAcceptanceTest() {
    known_.startDive(1, {});
    for (int i = 0; i < 80; ++i) {
      KnownKeyframe keyframe;
      keyframe.id = i < 40 ? i : 60 + i;
      keyframe.dive = 1;
      keyframe.odom_from_body.translation.x() = 0.5 * (i % 40);
      keyframe.map_from_body = keyframe.odom_from_body;
      keyframe.path_m = 0.5 * i;
      RelativePose step;
      if (i > 0) step.from_from_to = known_.all().back().odom_from_body.inverse() * keyframe.odom_from_body;
      step.covariance = 1e-6 * Mat6::Identity();
      known_.add(keyframe, i > 0 ? &step : nullptr);
    }
  }

  /// A loop between the same places of both laps, off by `error_m`.
  VerifiedLoop loop(int place, double error_m = 0.0) const {
    VerifiedLoop verified;
    verified.loop.old_keyframe = place;
    verified.loop.new_keyframe = 100 + place;
    verified.loop.status = LoopStatus::Verified;
    verified.loop.old_from_new.translation.y() = error_m;
    verified.loop.covariance = 1e-4 * Mat6::Identity();
    return verified;
  }

  KnownKeyframes known_;
  LoopAcceptance acceptance_;
};

TEST_F(LoopAcceptanceTest, NeedsASecondLoopThatAgrees) {
  EXPECT_TRUE(acceptance_.add(loop(3), {.has_prediction = true}, known_).empty());
  const std::vector<VerifiedLoop> accepted = acceptance_.add(loop(5), {.has_prediction = true}, known_);
  ASSERT_EQ(accepted.size(), 2u);
  for (const VerifiedLoop& verified : accepted) EXPECT_EQ(verified.loop.status, LoopStatus::Accepted);
}

TEST_F(LoopAcceptanceTest, NeedsThreeWithoutAPrediction) {
  EXPECT_TRUE(acceptance_.add(loop(3), {}, known_).empty());
  EXPECT_TRUE(acceptance_.add(loop(5), {}, known_).empty());
  EXPECT_EQ(acceptance_.add(loop(7), {}, known_).size(), 3u);
}

// Where the field tells places apart, loops that agree wait until it supports most of them.
TEST_F(LoopAcceptanceTest, NeedsTheFieldWhereItTells) {
  const LoopEvidence evidence{.needs_field = true};
  const auto with = [&](int place, int values, double log_ratio) {
    VerifiedLoop verified = loop(place);
    verified.loop.field = FieldAgreement{.chi_squared = 30.0, .values = values, .log_ratio = log_ratio};
    return verified;
  };
  EXPECT_TRUE(acceptance_.add(with(3, 30, -3.0), evidence, known_).empty());
  EXPECT_TRUE(acceptance_.add(loop(5), evidence, known_).empty());
  EXPECT_TRUE(acceptance_.add(with(7, 9, 8.0), evidence, known_).empty()) << "few readings";
  EXPECT_TRUE(acceptance_.add(with(9, 30, 8.0), evidence, known_).empty()) << "one of two";
  EXPECT_EQ(acceptance_.add(with(11, 30, 8.0), evidence, known_).size(), 5u);
  EXPECT_EQ(acceptance_.add(loop(13), evidence, known_).size(), 1u);
}

TEST_F(LoopAcceptanceTest, RefusesWhatTheFieldDoesNotSupport) {
  const LoopEvidence evidence{.needs_field = true};
  for (const int place : {3, 5, 7, 9}) acceptance_.add(loop(place), evidence, known_);
  const std::vector<VerifiedLoop> refused = acceptance_.expire(139, known_);
  ASSERT_EQ(refused.size(), 4u);
  EXPECT_NE(refused.front().loop.reason.find("magnetic field"), std::string::npos);
}

TEST_F(LoopAcceptanceTest, LetsAFalseLoopWaitAndRefusesItInTheEnd) {
  acceptance_.add(loop(3), {.has_prediction = true}, known_);
  acceptance_.add(loop(5), {.has_prediction = true}, known_);
  EXPECT_TRUE(acceptance_.add(loop(7, 2.0), {.has_prediction = true}, known_).empty());
  EXPECT_TRUE(acceptance_.expire(108, known_).empty());
  const std::vector<VerifiedLoop> refused = acceptance_.expire(139, known_);
  ASSERT_EQ(refused.size(), 1u);
  EXPECT_EQ(refused.front().loop.status, LoopStatus::Refused);
  EXPECT_FALSE(refused.front().loop.reason.empty());
}

TEST_F(LoopAcceptanceTest, DoesNotLetFalseLoopsThatAgreeOutvoteThoseInUse) {
  for (int place = 3; place < 11; place += 2) acceptance_.add(loop(place), {.has_prediction = true}, known_);
  EXPECT_TRUE(acceptance_.add(loop(12, 2.0), {.has_prediction = true}, known_).empty());
  EXPECT_TRUE(acceptance_.add(loop(13, 2.0), {.has_prediction = true}, known_).empty());
}

TEST_F(LoopAcceptanceTest, PredictsThroughAnAcceptedLoop) {
  RelativePose measured;
  measured.covariance = 1e-8 * Mat6::Identity();
  measured.from_from_to.translation.y() = 0.5;
  known_.addLoop(10, 110, measured);
  const auto prediction = known_.predict(12, 112);
  ASSERT_TRUE(prediction.has_value());
  EXPECT_NEAR(prediction->old_from_new.translation.y(), 0.5, 1e-9);
  const auto extent = [](const Mat6& covariance) {
    const Mat3 of_position = covariance.topLeftCorner<3, 3>();
    return of_position.trace();
  };
  EXPECT_LT(extent(prediction->covariance), extent(known_.between(12, 112).covariance));
}

}  // namespace
}  // namespace lodeline
