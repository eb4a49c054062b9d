#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "apps/lodeline/program/command_tree.h"
#include "apps/lodeline/program/help_formatter.h"
#include "apps/lodeline/program/manual_command.h"
#include "apps/lodeline/program/shell_completion.h"
#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

/// A program with one plain command and one with a command below it.
class ProgramHelp : public ::testing::Test {
 protected:
  ProgramHelp() {
    program_.name("lodeline");
    CLI::App* run = program_.add_subcommand("run", "Estimate a trajectory and a map from a recording");
    run->add_option("DATA", data_, "folder of the recording")->required();
    run->add_option("-o,--output", output_, "folder for the results, which is made where it is missing")
        ->type_name("FOLDER")
        ->required();
    run->add_option("--rate", rate_, "times as fast")->capture_default_str()->group("Screen");
    run->add_flag("-q,--quiet", quiet_, "no progress")->group("Screen");
    run->footer("Example:\n  lodeline run dive1 -o out");
    CLI::App* calibrate = program_.add_subcommand("calibrate", "Calibrate a sensor");
    calibrate->add_subcommand("magnetometer", "Its iron")->add_option("--site", data_, "the user's place");
  }

  std::string help(size_t width) const {
    const HelpFormatter formatter(width, false);
    return formatter.make_help(program_.get_subcommand("run"), "lodeline run", CLI::AppFormatMode::Normal);
  }

  CLI::App program_{"Where a rig went"};
  std::string data_, output_;
  double rate_ = 2.5;
  bool quiet_ = false;
};

size_t longestLine(const std::string& text) {
  std::istringstream lines(text);
  size_t longest = 0;
  for (std::string line; std::getline(lines, line);) longest = std::max(longest, line.size());
  return longest;
}

TEST_F(ProgramHelp, StaysWithinTheWidth) {
  for (const size_t width : {40u, 60u, 80u}) EXPECT_LE(longestLine(help(width)), width);
  EXPECT_GT(longestLine(help(80)), 60u);
}

TEST_F(ProgramHelp, HasGroupsDefaultsAndRequiredOptions) {
  const std::string text = help(100);
  EXPECT_NE(text.find("\nScreen:\n"), std::string::npos) << text;
  EXPECT_NE(text.find("times as fast (default: 2.5)"), std::string::npos) << text;
  EXPECT_NE(text.find("lodeline run DATA --output FOLDER [OPTIONS]"), std::string::npos) << text;
  EXPECT_EQ(text.find("no progress (default"), std::string::npos) << "a flag has no default";
}

TEST_F(ProgramHelp, ListsTheCommandsWithoutOthersBelow) {
  const std::vector<LeafCommand> leaves = leafCommands(program_);
  ASSERT_EQ(leaves.size(), 2u);
  EXPECT_EQ(leaves[1].words, (std::vector<std::string>{"calibrate", "magnetometer"}));
}

TEST_F(ProgramHelp, MakesAManualPageWithAllOptions) {
  const std::string page = manualPage(leafCommands(program_)[0], "1.2");
  EXPECT_NE(page.find(".TH \"lodeline\\-run\" 1"), std::string::npos) << page;
  EXPECT_NE(page.find(".B \\-o, \\-\\-output FOLDER"), std::string::npos) << page;
  EXPECT_NE(page.find("lodeline run dive1 \\-o out"), std::string::npos) << page;
  EXPECT_NE(manualIndex(program_, "1.2").find("lodeline\\-calibrate\\-magnetometer"), std::string::npos);
}

TEST_F(ProgramHelp, CompletesForEveryShell) {
  const std::string bash = completionScript(program_, "bash");
  EXPECT_NE(bash.find("'calibrate magnetometer') proposals='--help --site' ;;"), std::string::npos) << bash;
  const std::string fish = completionScript(program_, "fish");
  EXPECT_NE(fish.find("-l site -r -d 'the user\\'s place'"), std::string::npos) << fish;
  EXPECT_NE(completionScript(program_, "zsh").find("bashcompinit"), std::string::npos);
  EXPECT_THROW(completionScript(program_, "cmd"), UsageError);
}

}  // namespace
}  // namespace lodeline
