#include "lodeline/pipeline/output_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <functional>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class OutputChoice : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "dive/mav0/cam0");
  }
  void TearDown() override { fs::remove_all(folder_); }

  static std::string refusal(const std::function<void()>& choice) {
    try {
      choice();
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  }

  fs::path folder_ = fs::path(testing::TempDir()) / "lodeline_output_choice";
};

TEST_F(OutputChoice, TheRecordingIsNoFolderForResults) {
  const fs::path data = folder_ / "dive";
  fs::create_directory_symlink(data, folder_ / "link");
  for (const fs::path& output :
       {data, data / "", data / "mav0", data / "mav0/cam0/out", data / "../dive", folder_ / "link"}) {
    EXPECT_THAT(refusal([&] { refuseRecordingAsOutput(data, output); }), HasSubstr("holds a recording"))
        << output;
    EXPECT_THAT(refusal([&] { refuseRecordingAsOutput(data / "mav0", output); }),
                HasSubstr("holds a recording"))
        << output;
  }
}

TEST_F(OutputChoice, AFolderBesideTheSensorsIsGood) {
  const fs::path data = folder_ / "dive";
  for (const fs::path& output : {folder_ / "out", data / "out", data / "mav0_out", folder_}) {
    EXPECT_EQ(refusal([&] { refuseRecordingAsOutput(data, output); }), "") << output;
  }
  EXPECT_EQ(refusal([&] { refuseRecordingAsOutput(folder_ / "dive.bag", folder_ / "out"); }), "");
}

TEST_F(OutputChoice, AnotherRunIsNotReplaced) {
  fs::create_directories(folder_ / "out");
  std::ofstream(folder_ / "out/notes.txt") << "mine";
  EXPECT_EQ(refusal([&] { refuseToReplaceRun(folder_ / "out"); }), "");
  std::ofstream(folder_ / "out/trajectory.tum") << "#";
  EXPECT_THAT(refusal([&] { refuseToReplaceRun(folder_ / "out"); }), HasSubstr("--overwrite"));
}

}  // namespace
}  // namespace lodeline
