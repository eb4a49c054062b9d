#include "lodeline/io/euroc/image_list.h"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "lodeline/diagnostics.h"
#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/io/euroc/test_recording.h"

namespace lodeline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

class ImageListTest : public testing::Test {
 protected:
  std::vector<ListedImage> list(const std::string& camera) {
    ImageList images(recording_.path(camera), &diagnostics_);
    std::vector<ListedImage> all;
    while (const auto image = images.next()) all.push_back(*image);
    return all;
  }

  /// Removes the list and renames the images by number.
  void rename(const std::string& camera, const std::function<std::string(int)>& name) {
    std::filesystem::remove(recording_.path(camera + "/data.csv"));
    for (int i = 0; i <= 20; ++i) {
      const auto folder = recording_.path(camera + "/data");
      std::filesystem::rename(folder / (testStamp(1.0 + 0.05 * i) + ".png"), folder / name(i));
    }
  }

  TestRecording recording_;
  Diagnostics diagnostics_;
};

TEST_F(ImageListTest, NamesThatAreStampsMakeTheList) {
  const std::vector<ListedImage> listed = list("cam0");
  std::filesystem::remove(recording_.path("cam0/data.csv"));
  recording_.write("cam0/data/notes.txt", "no image");
  const std::vector<ListedImage> made = list("cam0");
  ASSERT_EQ(made.size(), 21u);
  for (size_t i = 0; i < made.size(); ++i) {
    EXPECT_EQ(made[i].time, listed[i].time);
    EXPECT_EQ(made[i].file, listed[i].file);
  }
}

TEST_F(ImageListTest, NamesInSeconds) {
  rename("cam0", [](int i) {
    const std::string ns = testStamp(1.0 + 0.05 * i);
    return ns.substr(0, 10) + "." + ns.substr(10) + ".png";
  });
  EXPECT_EQ(list("cam0")[3].time, testTime(1.15));
}

TEST_F(ImageListTest, NumberedImagesTakeTheTimesOfATimesFile) {
  rename("cam0", [](int i) { return fmt::format("frame{}.png", i); });
  std::string times = "# seconds\n";
  for (int i = 0; i <= 20; ++i) times += testStamp(1.0 + 0.05 * i) + "\n";
  std::ofstream(recording_.folder() / "timestamps.txt") << times;
  const std::vector<ListedImage> made = list("cam0");
  ASSERT_EQ(made.size(), 21u);
  EXPECT_EQ(made[11].time, testTime(1.55));
  EXPECT_EQ(made[11].file.filename(), "frame11.png");
}

TEST_F(ImageListTest, CountsAreNoStamps) {
  rename("cam0", [](int i) { return fmt::format("{:06}.png", i); });
  std::ofstream(recording_.folder() / "times.txt") << "1.0\n1.1\n";
  EXPECT_THAT([&] { list("cam0"); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("cam0/data.csv: missing"), HasSubstr("21 images"),
                                              HasSubstr("times.txt has 2 times"))));
}

TEST_F(ImageListTest, ARecordingWithoutAnyListIsReadWithANotice) {
  for (const char* camera : {"cam0", "cam1"}) {
    std::filesystem::remove(recording_.path(std::string(camera) + "/data.csv"));
  }
  EurocSource source(recording_.folder(), {}, &diagnostics_);
  EXPECT_EQ(source.rig().cameras.size(), 2u);
  EXPECT_EQ(source.nextImage(1)->time, testTime(1.0));
  ASSERT_EQ(diagnostics_.count("image_list_made"), 2);
  EXPECT_EQ(diagnostics_.ranked()[0].severity, Severity::Notice);
}

TEST_F(ImageListTest, OneMissingListIsAWarning) {
  std::filesystem::remove(recording_.path("cam1/data.csv"));
  EurocSource source(recording_.folder(), {}, &diagnostics_);
  EXPECT_EQ(source.rig().cameras.size(), 2u);
  ASSERT_EQ(diagnostics_.ranked().size(), 1u);
  EXPECT_EQ(diagnostics_.ranked()[0].severity, Severity::Warning);
  EXPECT_THAT(diagnostics_.ranked()[0].first_message, HasSubstr("cam1/data.csv: missing"));
}

TEST_F(ImageListTest, ACameraWithoutImagesIsLeftOutWithAWarning) {
  rename("cam1", [](int i) { return fmt::format("{:06}.png", i); });
  EurocSource source(recording_.folder(), {}, &diagnostics_);
  ASSERT_EQ(source.rig().cameras.size(), 1u);
  EXPECT_EQ(diagnostics_.count("camera_left_out"), 1);
  EXPECT_THAT(diagnostics_.ranked()[0].first_message, HasSubstr("cam1 is left out"));
  EurocOptions both;
  both.camera_indices = {0, 1};
  EXPECT_THAT([&] { EurocSource(recording_.folder(), both, &diagnostics_); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("cam1/data.csv"), HasSubstr("asked for"))));
}

}  // namespace
}  // namespace lodeline
