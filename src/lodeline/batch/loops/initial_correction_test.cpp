#include "lodeline/batch/loops/initial_correction.h"

#include <gtest/gtest.h>

#include <limits>

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

Time timeAt(double seconds) { return Time::fromNanoseconds(1'000'000'000) + Duration::fromSeconds(seconds); }

/// A straight way east with a tilted body.
std::vector<FrameEstimate> straightRun() {
  std::vector<FrameEstimate> frames(11);
  for (int i = 0; i <= 10; ++i) {
    FrameEstimate& frame = frames[static_cast<size_t>(i)];
    frame.time = frame.state.time = timeAt(i);
    frame.state.world_from_body = Rigid3(so3::exp(Vec3(0.1, -0.2, 0.0)), Vec3(i, 0.0, -1.0));
    frame.state.velocity_W = Vec3::UnitX();
    frame.state.gyroscope_bias_B = Vec3(1e-3, 0.0, 0.0);
  }
  return frames;
}

Rigid3 turned(const Rigid3& pose, double turn_rad, const Vec3& shift) {
  const Quat turn = so3::exp(turn_rad * Vec3::UnitZ());
  return Rigid3(turn * pose.rotation, turn * pose.translation + shift);
}

TEST(InitialCorrection, ReachesThePosesAndIsInterpolatedBetweenThem) {
  const std::vector<FrameEstimate> frames = straightRun();
  const Vec3 shift(0.5, -0.3, 0.2);
  const InitialCorrection correction(frames,
                                     {{timeAt(2.0), frames[2].state.world_from_body},
                                      {timeAt(6.0), turned(frames[6].state.world_from_body, 0.08, shift)}});
  const auto apply = [&](size_t i) { return correction.apply(frames[i].state); };
  EXPECT_LT(perturbationBetween(apply(0).world_from_body, frames[0].state.world_from_body).norm(), 1e-12);
  const Rigid3 wanted = turned(frames[6].state.world_from_body, 0.08, shift);
  EXPECT_LT(perturbationBetween(apply(6).world_from_body, wanted).norm(), 1e-12);
  const NavigationState half = apply(4);
  EXPECT_LT((half.velocity_W - so3::exp(0.04 * Vec3::UnitZ()) * Vec3::UnitX()).norm(), 1e-12);
  const Vec3 moved = turned(frames[4].state.world_from_body, 0.08, shift).translation;
  EXPECT_LT(
      (half.world_from_body.translation - 0.5 * (frames[4].state.world_from_body.translation + moved)).norm(),
      1e-12);
  EXPECT_EQ(half.gyroscope_bias_B, frames[4].state.gyroscope_bias_B);
  const Rigid3 after = turned(frames[9].state.world_from_body, 0.08, shift);
  EXPECT_LT(perturbationBetween(apply(9).world_from_body, after).norm(), 1e-12) << "constant after the last";
}

TEST(InitialCorrection, KeepsRollAndPitchOfTheRun) {
  const std::vector<FrameEstimate> frames = straightRun();
  Rigid3 tilted = frames[5].state.world_from_body;
  tilted.rotation = so3::exp(Vec3(0.02, 0.01, 0.0)) * tilted.rotation;
  const NavigationState state = InitialCorrection(frames, {{timeAt(5.0), tilted}}).apply(frames[5].state);
  const Vec3 left =
      so3::log(state.world_from_body.rotation * frames[5].state.world_from_body.rotation.conjugate());
  EXPECT_LT(left.head<2>().norm(), 1e-12);
}

TEST(InitialCorrection, TurnsTheShortWay) {
  const std::vector<FrameEstimate> frames = straightRun();
  const InitialCorrection correction(
      frames, {{timeAt(1.0), turned(frames[1].state.world_from_body, 3.1, Vec3::Zero())},
               {timeAt(3.0), turned(frames[3].state.world_from_body, -3.1, Vec3::Zero())}});
  const Vec3 velocity_W = correction.apply(frames[2].state).velocity_W;
  EXPECT_LT((velocity_W + Vec3::UnitX()).norm(), 1e-9) << "half a turn, not none";
}

TEST(InitialCorrection, IsNoneWithoutPoses) {
  const std::vector<FrameEstimate> frames = straightRun();
  const NavigationState state = InitialCorrection(frames, {}).apply(frames[3].state);
  EXPECT_EQ(state.world_from_body.translation, frames[3].state.world_from_body.translation);
  EXPECT_EQ(state.velocity_W, frames[3].state.velocity_W);
}

TEST(InitialCorrection, RefusesPosesThatCannotBeUsed) {
  const std::vector<FrameEstimate> frames = straightRun();
  const Rigid3 pose = frames[2].state.world_from_body;
  EXPECT_THROW(InitialCorrection(frames, {{timeAt(2.5), pose}}), InputError);
  EXPECT_THROW(InitialCorrection(frames, {{timeAt(20.0), pose}}), InputError);
  EXPECT_THROW(InitialCorrection(frames, {{timeAt(3.0), pose}, {timeAt(2.0), pose}}), InputError);
  EXPECT_THROW(InitialCorrection(frames, {{timeAt(2.0), pose}, {timeAt(2.0), pose}}), InputError);
  Rigid3 broken = pose;
  broken.translation.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(InitialCorrection(frames, {{timeAt(2.0), broken}}), InputError);
}

}  // namespace
}  // namespace lodeline
