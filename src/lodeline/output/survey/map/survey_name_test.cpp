#include "lodeline/output/survey/map/survey_name.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lodeline {
namespace {

using ::testing::ElementsAre;

TEST(SurveyName, HasOnlyWhatSurveyProgramsTake) {
  EXPECT_EQ(surveyName("dive-1_a"), "dive-1_a");
  EXPECT_EQ(surveyName("Devil's Eye #2"), "Devil_s_Eye__2");
  EXPECT_EQ(surveyName("a.b/../c@d"), "a_b____c_d");
  EXPECT_EQ(surveyName("-o"), "_o");
  EXPECT_EQ(surveyName(""), "dive");
  EXPECT_EQ(surveyName(std::string(300, 'x')).size(), 64U);
}

TEST(SurveyNames, DifferWhateverTheFoldersAreCalled) {
  EXPECT_THAT(surveyNames({"/a/out/"}), ElementsAre("out"));
  EXPECT_THAT(surveyNames({"/a/dive1", "/a/dive2"}), ElementsAre("dive1", "dive2"));
  EXPECT_THAT(surveyNames({"/a/monday/out", "/a/tuesday/out"}), ElementsAre("monday_out", "tuesday_out"));
  // Survex ignores case.
  EXPECT_THAT(surveyNames({"/a/b/Out", "/a/c/out"}), ElementsAre("b_Out", "c_out"));
  EXPECT_THAT(surveyNames({"/a/ä", "/a/ö"}), ElementsAre("___1", "___2"));
}

}  // namespace
}  // namespace lodeline
