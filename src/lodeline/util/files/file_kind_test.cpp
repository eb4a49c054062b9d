#include "lodeline/util/files/file_kind.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "lodeline/util/error.h"

namespace lodeline {
namespace {

using ::testing::HasSubstr;
using namespace std::string_literals;

class FileKindTest : public testing::Test {
 protected:
  FileKindTest() { std::filesystem::create_directories(folder_); }
  ~FileKindTest() override { std::filesystem::remove_all(folder_); }

  RecognisedFile recognise(const std::string& name, const std::string& bytes) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return recogniseFile(folder_ / name);
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("lodeline_kind_" + std::to_string(getpid()));
};

TEST_F(FileKindTest, ContentCountsMoreThanTheName) {
  EXPECT_EQ(recognise("a.bag", "#ROSBAG V2.0\n").kind, FileKind::Ros1Bag);
  EXPECT_EQ(recognise("b.bag", "SQLite format 3\0more"s).kind, FileKind::Ros2Bag);
  EXPECT_EQ(recognise("c.bag", "\x89MCAP0\r\n").kind, FileKind::Mcap);
  EXPECT_EQ(recognise("d.csv", "PK\3\4").kind, FileKind::Archive);
  EXPECT_EQ(recognise("e.yaml", "7z\xBC\xAF\x27\x1C").kind, FileKind::Archive);
  EXPECT_EQ(recognise("f", "\x1F\x8B\x08").kind, FileKind::Compressed);
  EXPECT_EQ(recognise("g.csv", std::string(257, 'a') + "ustar").kind, FileKind::Archive);
  EXPECT_EQ(recognise("h", "\0\0\0\x20"s + "ftypmp42").kind, FileKind::Video);
  EXPECT_EQ(recognise("i", "RIFF\0\0\0\0AVI LIST"s).kind, FileKind::Video);
  EXPECT_EQ(recognise("j", "\x89PNG\r\n\x1A\n").kind, FileKind::Image);
  EXPECT_EQ(recognise("k.txt", "\x93NUMPY\1"s).kind, FileKind::Document);
  EXPECT_EQ(recognise("l.txt", "\1\2\3\4").kind, FileKind::Binary);
}

TEST_F(FileKindTest, NameCountsWhereTheContentSaysNothing) {
  EXPECT_EQ(recognise("a.db3", "").kind, FileKind::Ros2Bag);
  EXPECT_EQ(recognise("b.MP4", "x").kind, FileKind::Video);
  EXPECT_EQ(recognise("c", "").kind, FileKind::Empty);
}

TEST_F(FileKindTest, TellsTextsApart) {
  EXPECT_EQ(recognise("a.txt", "# t x y\n1.0 2.0 3.0\n").kind, FileKind::Table);
  EXPECT_EQ(recognise("b", "time;depth\r\n0;1,5\r\n").kind, FileKind::Table);
  EXPECT_EQ(recognise("c", "%YAML:1.0\na: 1\n").kind, FileKind::Yaml);
  EXPECT_EQ(recognise("d.yml", "a: 1\n").kind, FileKind::Yaml);
  EXPECT_EQ(recognise("e", " {\"value0\": 1}").kind, FileKind::Json);
  EXPECT_EQ(recognise("f", "\xFF\xFEt\0i\0"s).isText(), true);
  EXPECT_EQ(recognise("g", "word\n").kind, FileKind::Text);
  EXPECT_EQ(recognise("h", "#").kind, FileKind::Text);
}

TEST_F(FileKindTest, TellsFoldersApart) {
  EXPECT_EQ(recogniseFile(folder_).what, "an empty folder");
  recognise("ros2/metadata.yaml", "a: 1");
  recognise("ros2/dive_0.db3", "");
  EXPECT_EQ(recogniseFile(folder_ / "ros2").kind, FileKind::Ros2Folder);
  EXPECT_THAT(recogniseFile(folder_ / "ros2").advice, HasSubstr("rosbags-convert"));
  recognise("loose/1.png", "");
  recognise("loose/2.JPG", "");
  EXPECT_THAT(recogniseFile(folder_ / "loose").what, HasSubstr("2 pictures"));
  recognise("packed/b.zip", "");
  recognise("packed/a.zip", "");
  EXPECT_THAT(recogniseFile(folder_ / "packed").advice, HasSubstr("a.zip"));
  recognise("recording/mav0/x", "");
  recognise("recording/readme.zip", "");
  EXPECT_EQ(recogniseFile(folder_ / "recording").kind, FileKind::EurocFolder);
  recognise("bags/x.bag", "");
  EXPECT_THAT(recogniseFile(folder_ / "bags").advice, HasSubstr("x.bag"));
  recognise("run/run.json", "{}");
  EXPECT_EQ(recogniseFile(folder_ / "run").kind, FileKind::RunFolder);
}

TEST_F(FileKindTest, SaysWhatIsMissing) {
  EXPECT_EQ(recogniseFile(folder_ / "none").kind, FileKind::Missing);
  std::filesystem::create_symlink("loop", folder_ / "loop");
  EXPECT_THAT(recogniseFile(folder_ / "loop").what, HasSubstr("not readable"));
  const RecognisedFile zip = recognise("dive.zip", "PK\3\4");
  EXPECT_THAT(refusalText(zip, "a folder is needed"), HasSubstr("dive.zip: is an archive (zip); unpack it"));
  EXPECT_THAT(refusalText(recognise("x.png", "\x89PNG\r\n"), "a folder is needed"),
              HasSubstr("is a picture (PNG); a folder is needed"));
  EXPECT_THROW(refuseFile(zip, ""), InputError);
}

}  // namespace
}  // namespace lodeline
