#include "lodeline/inspection/survey/stream_survey.h"

#include <gtest/gtest.h>

namespace lodeline {
namespace {

Time at(double seconds) { return Time::fromSeconds(1000.0 + seconds); }

TEST(StreamSurvey, CountsWhatIsWrong) {
  StreamSurvey survey;
  for (int i = 0; i < 1000; ++i) {
    if (i >= 300 && i < 350) continue;
    survey.add(at(0.01 * i));
    if (i == 100) survey.add(at(0.01 * i));
    if (i == 200) survey.add(at(0.01 * i - 0.025));
  }
  const StreamSummary summary = survey.summarize(4.0);
  EXPECT_EQ(summary.readings, 952);
  EXPECT_NEAR(summary.rate_hz, 100.0, 1e-6);
  EXPECT_EQ(summary.duplicates, 1);
  EXPECT_EQ(summary.backwards, 1);
  ASSERT_EQ(summary.gaps.size(), 1u);
  EXPECT_NEAR(summary.gaps[0].length_s, 0.51, 1e-9);
  EXPECT_EQ(summary.gaps[0].after, at(2.99));
  EXPECT_EQ(summary.longest_frozen_s, 0.0);
}

TEST(StreamSurvey, TellsAFrozenSensorFromOneThatIsReadTooOften) {
  StreamSurvey hung, twice;
  for (int i = 0; i < 1000; ++i) {
    hung.add(at(0.01 * i), i > 400 && i <= 700);
    twice.add(at(0.01 * i), i % 2 == 1);
  }
  EXPECT_NEAR(hung.summarize(4.0).longest_frozen_s, 3.0, 1e-9);
  EXPECT_NEAR(hung.summarize(4.0).frozen_share, 0.3, 1e-3);
  EXPECT_EQ(twice.summarize(4.0).repeated, 500);
  EXPECT_EQ(twice.summarize(4.0).frozen_share, 0.0);
}

TEST(StreamSurvey, BearsEmptyAndSingleStreams) {
  StreamSurvey survey;
  EXPECT_EQ(survey.summarize(4.0).readings, 0);
  survey.add(at(0.0));
  EXPECT_EQ(survey.summarize(4.0).readings, 1);
  EXPECT_EQ(survey.summarize(4.0).rate_hz, 0.0);
}

}  // namespace
}  // namespace lodeline
