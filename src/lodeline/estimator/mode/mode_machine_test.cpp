#include "lodeline/estimator/mode/mode_machine.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include "lodeline/util/files/test_data.h"

namespace lodeline {
namespace {

constexpr double kUnknown = 1.0, kKnown = 0.01;

/// A machine that is taken from frame to frame, ten a second.
class ModeMachineTest : public testing::Test {
 protected:
  void start(bool scale_is_given) { machine_.start(scale_is_given, 0); }

  /// Returns what see() returned.
  bool frame(bool sees = true, double sigma = kKnown) {
    now_ = now_ + Duration::fromSeconds(0.1);
    machine_.addFrame();
    const bool was_dark = machine_.see(now_, sees);
    machine_.judgeScale(now_, sigma);
    return was_dark;
  }
  void frames(int count, bool sees = true, double sigma = kKnown) {
    for (int i = 0; i < count; ++i) frame(sees, sigma);
  }

  WindowOptions options_;
  ModeMachine machine_{options_};
  Time now_ = Time::fromSeconds(100.0);
};

TEST_F(ModeMachineTest, WaitsUntilItIsStarted) {
  EXPECT_EQ(machine_.mode(), Mode::Waiting);
  start(true);
  EXPECT_EQ(machine_.mode(), Mode::StartingUp);
  EXPECT_FALSE(machine_.isMarginalizing());
}

TEST_F(ModeMachineTest, AStereoStartTracksAfterItsFrames) {
  start(true);
  frames(options_.startup_frames - 1, true, kUnknown);
  EXPECT_EQ(machine_.mode(), Mode::StartingUp);
  frame(true, kUnknown);
  EXPECT_EQ(machine_.mode(), Mode::Tracking);
  EXPECT_TRUE(machine_.isSettled());
  EXPECT_TRUE(machine_.hasChanged());
  frame();
  EXPECT_FALSE(machine_.hasChanged());
}

TEST_F(ModeMachineTest, OneCameraTracksOnceItsScaleIsKnownAndItsLossesHaveAdapted) {
  start(false);
  frames(options_.startup_frames_mono + 5, true, kUnknown);
  EXPECT_EQ(machine_.mode(), Mode::StartingUp);
  frames(3);
  EXPECT_TRUE(machine_.isSettled());
  EXPECT_EQ(machine_.mode(), Mode::StartingUp);
  frame();
  EXPECT_EQ(machine_.mode(), Mode::Tracking);
}

TEST_F(ModeMachineTest, AWindowThatIsFullSlidesWithoutAScale) {
  start(false);
  frames(options_.startup_max_frames, true, kUnknown);
  EXPECT_EQ(machine_.mode(), Mode::Tracking);
  EXPECT_FALSE(machine_.isSettled());
  EXPECT_FALSE(machine_.isWorthKeeping(now_));
  frame();
  EXPECT_TRUE(machine_.isSettled());
  EXPECT_TRUE(machine_.hasChanged());
}

TEST_F(ModeMachineTest, AShortDarknessChangesNothing) {
  start(false);
  frames(options_.startup_frames_mono + 4);
  frame(false);
  EXPECT_EQ(machine_.mode(), Mode::InertialOnly);
  EXPECT_TRUE(machine_.isBlind());
  EXPECT_TRUE(machine_.isMarginalizing());
  EXPECT_FALSE(frame());
  EXPECT_EQ(machine_.mode(), Mode::Tracking);
  EXPECT_FALSE(machine_.scaleWasLost());
}

TEST_F(ModeMachineTest, AfterALongDarknessOneCameraRecoversItsScale) {
  start(false);
  frames(options_.startup_frames_mono + 4);
  frames(12, false);
  EXPECT_TRUE(frame());
  EXPECT_EQ(machine_.mode(), Mode::Recovering);
  EXPECT_TRUE(machine_.scaleWasLost());
  EXPECT_FALSE(machine_.isSettled());
  EXPECT_FALSE(machine_.isMarginalizing());
  frames(options_.startup_frames_mono + 4);
  EXPECT_EQ(machine_.mode(), Mode::Tracking);
}

TEST_F(ModeMachineTest, AMeasuredVelocityKeepsTheScaleOfOneCameraInTheDark) {
  start(false);
  frames(options_.startup_frames_mono + 4);
  const auto dark = [&](int count, bool has_velocity) {
    for (int i = 0; i < count; ++i) {
      now_ = now_ + Duration::fromSeconds(0.1);
      machine_.see(now_, false, has_velocity);
    }
  };
  dark(30, false);
  dark(1, true);
  dark(8, false);
  EXPECT_TRUE(frame()) << "linearization points are still those of inertial propagation";
  EXPECT_EQ(machine_.mode(), Mode::Tracking);
  EXPECT_FALSE(machine_.scaleWasLost());
  dark(1, true);
  dark(12, false);
  EXPECT_TRUE(frame());
  EXPECT_EQ(machine_.mode(), Mode::Recovering) << "the velocity was measured too long ago";
}

TEST_F(ModeMachineTest, RecoveringEndsWhereTheWindowIsFull) {
  start(false);
  frames(options_.startup_frames_mono + 4);
  frames(12, false);
  frames(options_.startup_max_frames + 1, true, kUnknown);
  EXPECT_EQ(machine_.mode(), Mode::Tracking);
  EXPECT_FALSE(machine_.isSettled());
}

TEST_F(ModeMachineTest, RecoveringMayBeLostAgain) {
  start(false);
  frames(options_.startup_frames_mono + 4);
  frames(12, false);
  frame();
  frame(false);
  EXPECT_EQ(machine_.mode(), Mode::InertialOnly);
  frame();
  EXPECT_EQ(machine_.mode(), Mode::Recovering);
}

TEST_F(ModeMachineTest, TwoCamerasKeepTheirScaleInTheDark) {
  start(true);
  frames(options_.startup_frames);
  frames(12, false);
  EXPECT_TRUE(frame());
  EXPECT_EQ(machine_.mode(), Mode::Tracking);
  EXPECT_TRUE(machine_.isSettled());
}

TEST_F(ModeMachineTest, AStartInTheDarkGoesOn) {
  start(true);
  frames(options_.startup_frames - 2);
  frames(3, false);
  EXPECT_EQ(machine_.mode(), Mode::InertialOnly);
  EXPECT_TRUE(machine_.isMarginalizing());
  frame();
  EXPECT_EQ(machine_.mode(), Mode::Tracking);
}

TEST_F(ModeMachineTest, KeepsLandmarksOfAStereoStartAfterFiveSeconds) {
  start(true);
  frames(options_.startup_frames);
  EXPECT_FALSE(machine_.isWorthKeeping(now_ + Duration::fromSeconds(4.9)));
  EXPECT_TRUE(machine_.isWorthKeeping(now_ + Duration::fromSeconds(5.0)));
}

TEST(ModeTransitions, HaveOneLineForAModeAndAnEvent) {
  std::set<std::pair<Mode, ModeEvent>> lines;
  for (const ModeTransition& line : modeTransitions()) {
    EXPECT_TRUE(lines.emplace(line.from, line.event).second) << toString(line.from);
  }
}

TEST(ModeTransitions, AreThoseOfTheDocumentation) {
  std::ifstream file(testSourceDir() / "docs/theory/modes.md");
  ASSERT_TRUE(file);
  std::stringstream text;
  text << file.rdbuf();
  const std::string page = text.str();
  std::string table = "| from | event | to |\n| --- | --- | --- |\n";
  for (const ModeTransition& t : modeTransitions()) {
    table += std::string("| ") + toString(t.from) + " | " + toString(t.event) + " | " +
             (t.to ? toString(*t.to) : "the mode before") + " |\n";
  }
  EXPECT_NE(page.find(table + "\n"), std::string::npos) << table;
}

}  // namespace
}  // namespace lodeline
