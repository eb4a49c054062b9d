#include "lodeline/io/images/image_loader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "lodeline/io/euroc/test_recording.h"

namespace lodeline {
namespace {

using testing::HasSubstr;

class ImageLoaderTest : public testing::Test {
 protected:
  std::filesystem::path file(const std::string& name) { return recording_.path(name); }
  TestRecording recording_;
};

TEST_F(ImageLoaderTest, TurnsEveryKindIntoEightBitGrey) {
  cv::imwrite(file("grey.png").string(), cv::Mat(3, 5, CV_8UC1, cv::Scalar(77)));
  cv::imwrite(file("deep.png").string(), cv::Mat(3, 5, CV_16UC1, cv::Scalar(77 * 257)));
  cv::imwrite(file("colour.png").string(), cv::Mat(3, 5, CV_8UC3, cv::Scalar(77, 77, 77)));
  cv::imwrite(file("alpha.png").string(), cv::Mat(3, 5, CV_8UC4, cv::Scalar(77, 77, 77, 9)));
  cv::imwrite(file("grey.pgm").string(), cv::Mat(3, 5, CV_8UC1, cv::Scalar(77)));
  cv::imwrite(file("grey.jpg").string(), cv::Mat(3, 5, CV_8UC1, cv::Scalar(77)));
  for (const char* name : {"grey.png", "deep.png", "colour.png", "alpha.png", "grey.pgm", "grey.jpg"}) {
    const LoadedImage loaded = loadGreyImage(file(name));
    ASSERT_EQ(loaded.image.type(), CV_8UC1) << name;
    EXPECT_EQ(loaded.image.size(), cv::Size(5, 3)) << name;
    EXPECT_NEAR(loaded.image.at<uint8_t>(2, 4), 77, 1) << name;
    EXPECT_EQ(loaded.problem, "") << name;
  }
}

TEST_F(ImageLoaderTest, SaysWhyThereIsNoImage) {
  EXPECT_THAT(loadGreyImage(file("none.png")).problem, HasSubstr("none.png: image missing"));
  recording_.write("empty.png", "");
  EXPECT_THAT(loadGreyImage(file("empty.png")).problem, HasSubstr("empty.png: image file empty"));
  recording_.write("text.png", "this is no image");
  EXPECT_THAT(loadGreyImage(file("text.png")).problem, HasSubstr("text.png: image damaged"));
  EXPECT_THAT(loadGreyImage(recording_.folder()).problem, HasSubstr("unreadable"));
}

TEST_F(ImageLoaderTest, RefusesATruncatedImage) {
  const std::filesystem::path image = recording_.image(0, 1.0);
  std::filesystem::resize_file(image, std::filesystem::file_size(image) / 2);
  const LoadedImage loaded = loadGreyImage(image);
  EXPECT_TRUE(loaded.image.empty());
  EXPECT_THAT(loaded.problem, HasSubstr("damaged"));
}

TEST_F(ImageLoaderTest, RefusesAJpegFileThatWasCutOff) {
  cv::Mat noise(64, 96, CV_8UC1);
  cv::RNG(5).fill(noise, cv::RNG::UNIFORM, 0, 256);
  cv::imwrite(file("whole.jpg").string(), noise);
  ASSERT_FALSE(loadGreyImage(file("whole.jpg")).image.empty());
  std::filesystem::copy_file(file("whole.jpg"), file("cut.jpg"));
  const auto size = std::filesystem::file_size(file("cut.jpg"));
  std::filesystem::resize_file(file("cut.jpg"), size / 2);
  EXPECT_TRUE(loadGreyImage(file("cut.jpg")).image.empty());
  EXPECT_THAT(loadGreyImage(file("cut.jpg")).problem, HasSubstr("cut.jpg: image damaged"));
  // An image that lacks only its end marker is complete.
  std::filesystem::copy_file(file("whole.jpg"), file("unmarked.jpg"));
  std::filesystem::resize_file(file("unmarked.jpg"), size - 2);
  EXPECT_FALSE(loadGreyImage(file("unmarked.jpg")).image.empty());
}

TEST_F(ImageLoaderTest, ScalesSixteenBitsByTheRangeInUse) {
  cv::imwrite(file("deep.png").string(), cv::Mat(3, 5, CV_16UC1, cv::Scalar(4 * 77)));
  EXPECT_EQ(loadGreyImage(file("deep.png"), GreyRange{0, 2}).image.at<uint8_t>(1, 1), 77);
  cv::imwrite(file("deep.pgm").string(), cv::Mat(3, 5, CV_16UC1, cv::Scalar(4 * 77)));
  EXPECT_EQ(loadGreyImage(file("deep.pgm"), GreyRange{0, 2}).image.at<uint8_t>(1, 1), 77);
}

}  // namespace
}  // namespace lodeline
