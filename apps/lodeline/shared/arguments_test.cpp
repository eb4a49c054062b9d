#include "apps/lodeline/shared/arguments.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(Arguments, PlacesTakeBlanksAndCommas) {
  const auto joined = withJoinedPlaces;
  const auto expected = ElementsAre("run", "DATA", "--site=20.32,-87.39,5", "-q");
  EXPECT_THAT(joined({"run", "DATA", "--site", "20.32,-87.39,5", "-q"}), expected);
  EXPECT_THAT(joined({"run", "DATA", "--site", "20.32", "-87.39", "5", "-q"}), expected);
  EXPECT_THAT(joined({"run", "DATA", "--site", "20.32 -87.39 5", "-q"}), expected);
  EXPECT_THAT(joined({"run", "DATA", "--site", "20.32, -87.39, 5", "-q"}), expected);
  EXPECT_THAT(joined({"run", "DATA", "--site", "20.32,", "-87.39,", "5", "-q"}), expected);
  EXPECT_THAT(joined({"run", "DATA", "--site=20.32 -87.39 5", "-q"}), expected);
  EXPECT_THAT(joined({"--entrance", "-20", "-87", "5", "7"}), ElementsAre("--entrance=-20,-87,5", "7"));
  EXPECT_THAT(joined({"--entrance", "Florida", "5"}), ElementsAre("--entrance", "Florida", "5"));
  EXPECT_THAT(joined({"--background-at", "-20.3", "57.1"}), ElementsAre("--background-at=-20.3,57.1"));
  EXPECT_THAT(joined({"--set", "a=1", "2"}), ElementsAre("--set", "a=1", "2"));
}

class UnknownWords : public testing::Test {
 protected:
  UnknownWords() {
    CLI::App* run = program_.add_subcommand("run", "");
    run->add_option("--draw-tracks", number_);
    run->add_option("-o,--output", text_);
    program_.add_subcommand("refine", "");
    program_.add_subcommand("calibrate", "")->add_subcommand("magnetometer", "")->add_option("--to", number_);
  }

  std::string refusal(const std::vector<std::string>& words) const {
    try {
      refuseUnknownWords(program_, words);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  }

  CLI::App program_;
  double number_ = 0.0;
  std::string text_;
};

TEST_F(UnknownWords, TheNearestCommandIsSuggested) {
  EXPECT_THAT(refusal({"runn", "DATA"}), HasSubstr("did you mean 'run'?"));
  EXPECT_THAT(refusal({"refin", "DATA"}), HasSubstr("did you mean 'refine'?"));
  EXPECT_THAT(refusal({"xyzzy"}), HasSubstr("the commands are run, refine, calibrate"));
  EXPECT_THAT(refusal({"calibrate", "magnetomter"}), HasSubstr("did you mean 'magnetometer'?"));
}

TEST_F(UnknownWords, TheNearestOptionIsSuggested) {
  EXPECT_THAT(refusal({"run", "DATA", "--draw-track", "3"}), HasSubstr("did you mean '--draw-tracks'?"));
  EXPECT_THAT(refusal({"run", "DATA", "--output-dir=out"}), HasSubstr("did you mean '--output'?"));
  EXPECT_THAT(refusal({"calibrate", "magnetometer", "DATA", "--too", "3"}),
              HasSubstr("did you mean '--to'?"));
  EXPECT_THAT(refusal({"run", "--xyzzyxyzzy"}), HasSubstr("`lodeline run --help`"));
}

TEST_F(UnknownWords, GoodWordsPass) {
  EXPECT_EQ(refusal({}), "");
  EXPECT_EQ(refusal({"--version"}), "");
  EXPECT_EQ(refusal({"run", "DATA", "-o", "out", "--draw-tracks=3", "--help"}), "");
  EXPECT_EQ(refusal({"calibrate", "magnetometer", "DATA", "--to", "3"}), "");
}

}  // namespace
}  // namespace lodeline
