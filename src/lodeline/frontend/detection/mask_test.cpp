#include "lodeline/frontend/detection/mask.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <opencv2/imgcodecs.hpp>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

CameraCalibration cameraWithMask(const std::string& file) {
  CameraCalibration c;
  c.name = "cam1";
  c.width_px = 64;
  c.height_px = 48;
  c.mask_file = file;
  return c;
}

class Mask : public testing::Test {
 protected:
  std::string write(int width, int height) {
    const auto file = std::filesystem::path(testing::TempDir()) / "lodeline_mask_test.png";
    cv::imwrite(file.string(), cv::Mat(height, width, CV_8U, cv::Scalar(255)));
    return file.string();
  }
};

TEST_F(Mask, IsReadAtTheCamerasSize) {
  EXPECT_TRUE(loadMask(cameraWithMask("")).empty());
  const cv::Mat mask = loadMask(cameraWithMask(write(64, 48)));
  EXPECT_EQ(mask.size(), cv::Size(64, 48));
  EXPECT_EQ(mask.type(), CV_8UC1);
}

TEST_F(Mask, NamesCameraAndFileOfWhatIsWrong) {
  EXPECT_THAT([] { loadMask(cameraWithMask("/nowhere/mask.png")); },
              testing::ThrowsMessage<InputError>(
                  testing::AllOf(testing::HasSubstr("'cam1'"), testing::HasSubstr("/nowhere/mask.png"))));
  const std::string small = write(32, 48);
  EXPECT_THAT([&] { loadMask(cameraWithMask(small)); },
              testing::ThrowsMessage<InputError>(
                  testing::AllOf(testing::HasSubstr("32 x 48"), testing::HasSubstr("64 x 48"))));
}

}  // namespace
}  // namespace lodeline
