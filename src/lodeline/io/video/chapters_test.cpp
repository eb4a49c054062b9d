#include "lodeline/io/video/chapters.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/io/film/test_film.h"

namespace lodeline {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ChaptersTest : public testing::Test {
 protected:
  std::vector<std::string> from(const std::string& name) {
    std::vector<std::string> names;
    for (const auto& chapter : chaptersFrom(folder_.path(name), &diagnostics_)) {
      names.push_back(chapter.filename().string());
    }
    return names;
  }
  void add(std::initializer_list<const char*> names) {
    for (const char* name : names) folder_.write(name, "");
  }

  test::FilmFolder folder_;
  Diagnostics diagnostics_;
};

TEST_F(ChaptersTest, JoinsNewNames) {
  add({"GX010042.MP4", "GX020042.MP4", "GX030042.MP4", "GX010043.MP4", "GH020042.MP4"});
  EXPECT_THAT(from("GX010042.MP4"), ElementsAre("GX010042.MP4", "GX020042.MP4", "GX030042.MP4"));
  EXPECT_TRUE(diagnostics_.ranked().empty());
}

TEST_F(ChaptersTest, JoinsOldNames) {
  add({"GOPR0042.MP4", "GP010042.MP4", "GP020042.MP4"});
  EXPECT_THAT(from("GOPR0042.MP4"), ElementsAre("GOPR0042.MP4", "GP010042.MP4", "GP020042.MP4"));
}

TEST_F(ChaptersTest, NamesAMissingChapter) {
  add({"GX010042.MP4", "GX020042.MP4", "GX040042.MP4"});
  EXPECT_THAT(from("GX010042.MP4"), ElementsAre("GX010042.MP4", "GX020042.MP4"));
  const std::vector<Finding> findings = diagnostics_.ranked();
  ASSERT_EQ(findings.size(), 1U);
  EXPECT_EQ(findings[0].kind, "chapter_missing");
  EXPECT_EQ(findings[0].severity, Severity::Serious);
  EXPECT_THAT(findings[0].first_message, HasSubstr("GX030042.MP4: missing"));
}

TEST_F(ChaptersTest, StartsAtTheChapterGiven) {
  add({"GX010042.MP4", "GX020042.MP4", "GX030042.MP4"});
  EXPECT_THAT(from("GX020042.MP4"), ElementsAre("GX020042.MP4", "GX030042.MP4"));
  EXPECT_EQ(diagnostics_.count("chapter_left_out"), 1);
}

TEST_F(ChaptersTest, TakesOtherNamesAlone) {
  add({"GX010042.MP4", "dive.MP4", "GX01004.MP4", "GXAA0042.MP4", "GX000042.MP4"});
  for (const char* name : {"dive.MP4", "GX01004.MP4", "GXAA0042.MP4", "GX000042.MP4"}) {
    EXPECT_THAT(from(name), ElementsAre(name));
  }
}

}  // namespace
}  // namespace lodeline
