#include "lodeline/util/files/file_kind.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

using ::testing::HasSubstr;
using namespace std::string_literals;

class FileKindTest : public testing::Test {
 protected:
  FileKindTest() { std::filesystem::create_directories(folder_); }
  ~FileKindTest() override { std::filesystem::remove_all(folder_); }

  RecognizedFile recognize(const std::string& name, const std::string& bytes) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return recognizeFile(folder_ / name);
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("lodeline_kind_" + std::to_string(getpid()));
};

TEST_F(FileKindTest, ContentCountsMoreThanTheName) {
  EXPECT_EQ(recognize("a.bag", "#ROSBAG V2.0\n").kind, FileKind::Ros1Bag);
  EXPECT_EQ(recognize("b.bag", "SQLite format 3\0more"s).kind, FileKind::Ros2Bag);
  EXPECT_EQ(recognize("c.bag", "\x89MCAP0\r\n").kind, FileKind::Mcap);
  EXPECT_EQ(recognize("d.csv", "PK\3\4").kind, FileKind::Archive);
  EXPECT_EQ(recognize("e.yaml", "7z\xBC\xAF\x27\x1C").kind, FileKind::Archive);
  EXPECT_EQ(recognize("f", "\x1F\x8B\x08").kind, FileKind::Compressed);
  EXPECT_EQ(recognize("g.csv", std::string(257, 'a') + "ustar").kind, FileKind::Archive);
  EXPECT_EQ(recognize("h", "\0\0\0\x20"s + "ftypmp42").kind, FileKind::Video);
  EXPECT_EQ(recognize("i", "RIFF\0\0\0\0AVI LIST"s).kind, FileKind::Video);
  EXPECT_EQ(recognize("j", "\x89PNG\r\n\x1A\n").kind, FileKind::Image);
  EXPECT_EQ(recognize("k.txt", "\x93NUMPY\1"s).kind, FileKind::Document);
  EXPECT_EQ(recognize("k.csv", "ULog\1\x12\x35\1"s).kind, FileKind::SensorLog);
  EXPECT_EQ(recognize("k.txt", "\xA3\x95\x80\x80"s).kind, FileKind::SensorLog);
  EXPECT_EQ(recognize("l.txt", "\1\2\3\4").kind, FileKind::Binary);
}

TEST_F(FileKindTest, NameCountsWhereTheContentSaysNothing) {
  EXPECT_EQ(recognize("a.db3", "").kind, FileKind::Ros2Bag);
  EXPECT_EQ(recognize("b.MP4", "x").kind, FileKind::Video);
  EXPECT_EQ(recognize("c", "").kind, FileKind::Empty);
}

TEST_F(FileKindTest, TellsTextsApart) {
  EXPECT_EQ(recognize("a.txt", "# t x y\n1.0 2.0 3.0\n").kind, FileKind::Table);
  EXPECT_EQ(recognize("b", "time;depth\r\n0;1,5\r\n").kind, FileKind::Table);
  EXPECT_EQ(recognize("c", "%YAML:1.0\na: 1\n").kind, FileKind::Yaml);
  EXPECT_EQ(recognize("d.yml", "a: 1\n").kind, FileKind::Yaml);
  EXPECT_EQ(recognize("e", " {\"value0\": 1}").kind, FileKind::Json);
  EXPECT_EQ(recognize("f", "\xFF\xFEt\0i\0"s).isText(), true);
  EXPECT_EQ(recognize("g", "word\n").kind, FileKind::Text);
  EXPECT_EQ(recognize("h", "#").kind, FileKind::Text);
}

TEST_F(FileKindTest, TellsFoldersApart) {
  EXPECT_EQ(recognizeFile(folder_).what, "an empty folder");
  recognize("ros2/metadata.yaml", "a: 1");
  recognize("ros2/dive_0.db3", "");
  EXPECT_EQ(recognizeFile(folder_ / "ros2").kind, FileKind::Ros2Folder);
  recognize("loose/1.png", "");
  recognize("loose/2.JPG", "");
  EXPECT_THAT(recognizeFile(folder_ / "loose").what, HasSubstr("2 pictures"));
  recognize("packed/b.zip", "");
  recognize("packed/a.zip", "");
  EXPECT_THAT(recognizeFile(folder_ / "packed").advice, HasSubstr("a.zip"));
  recognize("recording/mav0/x", "");
  recognize("recording/readme.zip", "");
  EXPECT_EQ(recognizeFile(folder_ / "recording").kind, FileKind::EurocFolder);
  recognize("bags/x.bag", "");
  EXPECT_THAT(recognizeFile(folder_ / "bags").advice, HasSubstr("x.bag"));
  recognize("run/run.json", "{}");
  EXPECT_EQ(recognizeFile(folder_ / "run").kind, FileKind::RunFolder);
}

TEST_F(FileKindTest, SaysWhatIsMissing) {
  EXPECT_EQ(recognizeFile(folder_ / "none").kind, FileKind::Missing);
  std::filesystem::create_symlink("loop", folder_ / "loop");
  EXPECT_THAT(recognizeFile(folder_ / "loop").what, HasSubstr("not readable"));
  const RecognizedFile zip = recognize("dive.zip", "PK\3\4");
  EXPECT_THAT(refusalText(zip, "a folder is needed"), HasSubstr("dive.zip: is an archive (zip); unpack it"));
  EXPECT_THAT(refusalText(recognize("x.png", "\x89PNG\r\n"), "a folder is needed"),
              HasSubstr("is a picture (PNG); a folder is needed"));
  EXPECT_THROW(refuseFile(zip, ""), InputError);
}

}  // namespace
}  // namespace lodeline
