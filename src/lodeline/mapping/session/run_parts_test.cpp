// Tests of the small parts of a run's mapping: choice of keyframes, thread and ledger.
#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "lodeline/mapping/session/keyframe_choice.h"
#include "lodeline/mapping/session/loops/loop_ledger.h"
#include "lodeline/mapping/session/mapping_thread.h"

namespace lodeline {
namespace {

FrameEstimate at(double time_s, double east_m, Status status = Status::Tracking) {
  FrameEstimate estimate;
  estimate.status = status;
  estimate.state.time = Time::fromSeconds(time_s);
  estimate.state.world_from_body.translation.x() = east_m;
  return estimate;
}

TEST(KeyframeChoice, TakesFramesThatHaveMovedOrTurned) {
  KeyframeChoice choice({});
  EXPECT_FALSE(choice.add(at(0.0, 0.0, Status::Inertial))) << "it shows nothing";
  EXPECT_TRUE(choice.add(at(1.0, 0.0)));
  EXPECT_FALSE(choice.add(at(2.0, 0.2)));
  EXPECT_TRUE(choice.add(at(3.0, 0.45)));
  FrameEstimate turned = at(4.0, 0.45);
  turned.state.world_from_body.rotation = Quat(Eigen::AngleAxisd(0.3, Vec3::UnitZ()));
  EXPECT_TRUE(choice.add(turned));
}

TEST(KeyframeChoice, TakesSmallerMotionsOfARigThatStaysNearby) {
  KeyframeChoice choice({});
  EXPECT_TRUE(choice.add(at(1.0, 0.0)));
  EXPECT_FALSE(choice.add(at(2.0, 0.15))) << "too early for so little";
  EXPECT_TRUE(choice.add(at(2.6, 0.15)));
  EXPECT_FALSE(choice.add(at(60.0, 0.16))) << "at rest";
}

TEST(KeyframeChoice, RefusesOptionsThatMakeNoSense) {
  KeyframeChoiceOptions options;
  options.distance_m = 0.0;
  EXPECT_THROW(KeyframeChoice{options}, UsageError);
}

TEST(MappingThread, HandsOutResultsWithAFixedDelay) {
  MappingThread thread([](MapKeyframe keyframe) {
    MappingStep step;
    step.keyframe = keyframe.id;
    return step;
  });
  for (KeyframeId id = 0; id < 10; ++id) {
    MapKeyframe keyframe;
    keyframe.id = id;
    const std::optional<MappingStep> step = thread.add(keyframe);
    const bool is_due = id >= static_cast<KeyframeId>(MappingThread::kDelay);
    ASSERT_EQ(step.has_value(), is_due);
    if (is_due) {
      EXPECT_EQ(step->keyframe, id - static_cast<KeyframeId>(MappingThread::kDelay));
    }
  }
  const std::vector<MappingStep> rest = thread.finish();
  ASSERT_EQ(rest.size(), MappingThread::kDelay);
  EXPECT_EQ(rest.back().keyframe, 9);
}

TEST(MappingThread, PassesErrorsOn) {
  MappingThread thread([](MapKeyframe) -> MappingStep { throw std::runtime_error("disk full"); });
  thread.add({});
  EXPECT_THROW(thread.finish(), std::runtime_error);
}

TEST(LoopLedger, WritesARowForEachPair) {
  const std::filesystem::path file = std::filesystem::path(testing::TempDir()) / "lodeline_loops_test.csv";
  {
    LoopLedger ledger(file);
    Loop loop;
    loop.source = "geometry";
    loop.status = LoopStatus::Refused;
    loop.reason = "too few, and \"wrong\"";
    ledger.write(loop, {"a", "b", Time::fromNanoseconds(5), Time::fromNanoseconds(7)});
  }
  std::ifstream stream(file);
  std::string header, row;
  std::getline(stream, header);
  std::getline(stream, row);
  EXPECT_EQ(header.front(), '#');
  EXPECT_EQ(row.rfind("7,5,b,a,geometry,refused,\"too few, and \"\"wrong\"\"\",", 0), 0u) << row;
}

}  // namespace
}  // namespace lodeline
