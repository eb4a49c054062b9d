#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "apps/lodeline/tests/test_program.h"

namespace lodeline::test {
namespace {

std::filesystem::path emptyFolder(const std::string& name) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / name;
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

int shell(const std::string& command) { return std::system(command.c_str()); }

TEST(ProgramCommands, BashCompletesCommandsAndOptions) {
  // The completion function of bash is called as the shell calls it.
  const std::string script =
      "source <(" + quoted(programPath()) +
      " completion bash); complete_words() { COMP_WORDS=(\"$@\"); COMP_CWORD=$(($# - 1)); _lodeline; "
      "echo \"${COMPREPLY[*]}\"; }; "
      "[[ \"$(complete_words lodeline cali)\" == calibrate ]] && "
      "[[ \"$(complete_words lodeline calibrate mag)\" == magnetometer ]] && "
      "[[ \"$(complete_words lodeline run --mag)\" == *--mag-calibration* ]] && "
      "[[ \"$(complete_words lodeline map build --over)\" == --overwrite ]]";
  EXPECT_EQ(shell("bash -c " + quoted(std::filesystem::path(script))), 0);
}

TEST(ProgramCommands, SettingsAreAConfiguration) {
  const std::filesystem::path folder = emptyFolder("settings_command");
  const std::filesystem::path config = folder / "config.yaml";
  ASSERT_EQ(shell(quoted(programPath()) + " settings --set source.skip_s=3 > " + quoted(config)), 0);
  const std::string text = readText(config);
  EXPECT_NE(text.find("skip_s: 3"), std::string::npos);
  EXPECT_EQ(text.find("expert:"), std::string::npos);
  EXPECT_EQ(runProgram("settings --config " + quoted(config)).output, text);
  EXPECT_NE(runProgram("settings --expert").output.find("\nexpert:"), std::string::npos);
  EXPECT_EQ(runProgram("settings --set source.skip=3").exit_code, 2);
}

TEST(ProgramCommands, ManualHasAPageForEveryCommand) {
  const std::filesystem::path folder = emptyFolder("manual_command");
  ASSERT_EQ(runProgram("manual -o " + quoted(folder)).exit_code, 0);
  for (const char* page :
       {"lodeline.1", "lodeline-run.1", "lodeline-calibrate-magnetometer.1", "lodeline-map-build.1"})
    EXPECT_TRUE(std::filesystem::exists(folder / page)) << page;
}

TEST(ProgramCommands, HelpTellsGroupsAndSharedOptions) {
  const std::string text = runProgram("help run").output;
  for (const char* part :
       {"Recording:", "Place and time:", "Results:", "Screen:", "--from", "--cameras", "--site"})
    EXPECT_NE(text.find(part), std::string::npos) << part << "\n" << text;
  EXPECT_EQ(text.find("\033["), std::string::npos) << "colours in a pipe";
}

}  // namespace
}  // namespace lodeline::test
