#include "lodeline/output/report/run_summary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace lodeline {
namespace {

struct Stretch {
  Status status;
  int frames;
  int tracks = 100;
};

RunSummary summaryOf(const std::vector<Stretch>& stretches) {
  RunSummary summary;
  int frame = 0;
  for (const Stretch& stretch : stretches) {
    for (int i = 0; i < stretch.frames; ++i) {
      FrameEstimate estimate;
      estimate.time = Time::fromSeconds(100.0 + 0.05 * frame++);
      estimate.status = stretch.status;
      estimate.tracks = stretch.tracks;
      estimate.covariance.setIdentity();
      summary.add(estimate);
    }
  }
  return summary;
}

TEST(RunSummary, TrustsARunWhoseContradictionPassed) {
  const RunSummary summary = summaryOf(
      {{Status::Waiting, 10}, {Status::Tracking, 60}, {Status::Degraded, 40}, {Status::Tracking, 1}});
  EXPECT_EQ(summary.distrust(), "");
  const auto json = nlohmann::json::parse(summary.json({}));
  EXPECT_EQ(json["frames_degraded"], 40);
  EXPECT_FALSE(json.contains("do_not_trust"));
  EXPECT_THAT(summary.text({}), testing::HasSubstr("40 degraded"));
}

TEST(RunSummary, OnlyFramesWithVisionCountAsComplete) {
  RunSummary summary = summaryOf(
      {{Status::Tracking, 60}, {Status::Inertial, 20, 5}, {Status::Degraded, 10}, {Status::Tracking, 10}});
  summary.recorded_images = 140;
  EXPECT_DOUBLE_EQ(summary.completion(), 0.5);
  EXPECT_THAT(summary.text({}), testing::HasSubstr("50.0 % (70 of 140 images were tracked; 20 poses by"));
  Diagnostics diagnostics;
  summary.reportBlindStretches(&diagnostics);
  ASSERT_EQ(diagnostics.count("blind_stretch"), 1);
  EXPECT_THAT(diagnostics.ranked()[0].first_message, testing::HasSubstr("0:03.0 to 0:04.0"));
}

TEST(RunSummary, IsSixLinesUnlessAllFiguresAreWanted) {
  const RunSummary summary = summaryOf({{Status::Tracking, 60}});
  const auto lines = [](const std::string& text) { return std::count(text.begin(), text.end(), '\n'); };
  EXPECT_LE(lines(summary.text({})), 6);
  EXPECT_GT(lines(summary.text({}, true)), 6);
}

TEST(RunSummary, FindingsNameTimesSinceTheFirstFrame) {
  const RunSummary summary = summaryOf({{Status::Tracking, 60}});
  Diagnostics diagnostics;
  diagnostics.report(Severity::Warning, "image_missing", "no image at 101500000000 ns");
  EXPECT_THAT(summary.text(diagnostics), testing::HasSubstr("no image at 0:01.5"));
  EXPECT_EQ(nlohmann::json::parse(summary.json(diagnostics))["findings"][0]["message"],
            "no image at 0:01.500");
}

TEST(RunSummary, DistrustsARunThatEndsInAContradiction) {
  const RunSummary summary = summaryOf({{Status::Tracking, 99}, {Status::Degraded, 1}});
  const std::string reason =
      "images and inertial readings contradict each other in 1 of 100 frames, the last among them";
  EXPECT_EQ(summary.distrust(), reason);
  EXPECT_EQ(nlohmann::json::parse(summary.json({}))["do_not_trust"], reason);
  EXPECT_EQ(summary.text({}).rfind("  do not trust", 0), 0u) << "the summary says so first";
}

TEST(RunSummary, DistrustsARunThatIsContradictedInMostFrames) {
  EXPECT_NE(summaryOf({{Status::Degraded, 51}, {Status::Tracking, 49}}).distrust(), "");
  // Images with many tracks that are consistent with no motion.
  EXPECT_NE(summaryOf({{Status::Inertial, 51}, {Status::Tracking, 49}}).distrust(), "");
}

TEST(RunSummary, TrustsARunInTheDark) {
  EXPECT_EQ(summaryOf({{Status::Inertial, 90, 5}, {Status::Tracking, 10}}).distrust(), "");
}

}  // namespace
}  // namespace lodeline
