#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "apps/lodeline/tests/test_room.h"

// Tests of `lodeline run` with images that are missing, damaged or of the wrong kind.

namespace lodeline::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

using RunImages = RoomTest;

int colouredPixels(const cv::Mat& bgr) {
  cv::Mat hsv;
  cv::cvtColor(bgr, hsv, cv::COLOR_BGR2HSV);
  cv::Mat saturation;
  cv::extractChannel(hsv, saturation, 1);
  return cv::countNonZero(saturation > 100);
}

TEST_F(RunImages, MissingImageOfEitherCameraIsNamedAndBridged) {
  std::filesystem::remove(recording_.image(0, 12));
  std::filesystem::remove(recording_.image(1, 18));
  const Execution result = run();
  expectGoodResult(result);
  EXPECT_EQ(findings("image_unreadable"), 2);
  EXPECT_THAT(result.output, AllOf(HasSubstr(recording_.image(0, 12).string()), HasSubstr("missing")));
}

TEST_F(RunImages, ImageMissingInTheListOfTheOtherCameraIsReported) {
  editLines(recording_.csv("cam1"), [](auto& lines) { lines.erase(lines.begin() + 10); });
  const Execution result = run();
  expectGoodResult(result);
  EXPECT_EQ(findings("image_missing"), 1);
  EXPECT_THAT(result.output, AllOf(HasSubstr("cam1"), HasSubstr("0:00.450")));
}

TEST_F(RunImages, CorruptImageIsNamedAndBridged) {
  std::filesystem::resize_file(recording_.image(0, 10), 700);
  std::ofstream(recording_.image(0, 15)) << "no picture";
  std::ofstream(recording_.image(0, 20));
  const Execution result = run();
  expectGoodResult(result);
  EXPECT_EQ(findings("image_unreadable"), 3);
  EXPECT_THAT(result.output, AllOf(HasSubstr(recording_.image(0, 10).string()), HasSubstr("damaged")));
}

TEST_F(RunImages, ImageWithoutInertialReadingsIsPassedOver) {
  // The last 40 readings are 0.2 s: four images are later than the remaining ones.
  editLines(recording_.csv("imu0"), [](auto& lines) { lines.resize(lines.size() - 40); });
  const Execution result = run();
  expectGoodResult(result, kRoomImages - 4);
  EXPECT_EQ(findings("image_after_imu"), 4);
  EXPECT_THAT(result.output, HasSubstr("after the last IMU reading"));
}

TEST_F(RunImages, ImageBeforeTheFirstInertialReadingIsPassedOver) {
  // 0.5 s before the first image plus the time of three images.
  editLines(recording_.csv("imu0"),
            [](auto& lines) { lines.erase(lines.begin() + 1, lines.begin() + 1 + 100 + 25); });
  const Execution result = run();
  expectGoodResult(result, kRoomImages - 3);
  EXPECT_EQ(findings("image_before_imu"), 3);
}

TEST_F(RunImages, WrongResolutionEndsTheRunAndGivesBothSizes) {
  replaceText(recording_.sensor("cam0") / "sensor.yaml", "[320, 240]", "[640, 480]");
  const Execution result = run();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.output, AllOf(HasSubstr(recording_.image(0, 0).string()), HasSubstr("320 x 240"),
                                   HasSubstr("640 x 480")));
}

TEST_F(RunImages, AllImagesMissingIsBadInput) {
  for (size_t i = 0; i < recording_.image_names.size(); ++i) {
    std::filesystem::remove(recording_.image(0, i));
    std::filesystem::remove(recording_.image(1, i));
  }
  const Execution result = run();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.output, AllOf(HasSubstr("bad input"), HasSubstr("no image"),
                                   HasSubstr(recording_.image(0, 0).string())));
  EXPECT_EQ(findings("image_unreadable"), 2 * kRoomImages);
}

TEST_F(RunImages, TracksAreDrawnAsOftenAsAskedFor) {
  expectGoodResult(run("--draw-tracks 0.5"));
  for (int i = 0; i < kRoomImages; ++i) {
    const std::filesystem::path picture = output_ / "frames" / fmt::format("{}.png", roomImageStamp_ns(i));
    ASSERT_EQ(std::filesystem::exists(picture), i % 10 == 0) << i;
    if (i % 10 != 0) continue;
    const cv::Mat pixels = cv::imread(picture.string());
    EXPECT_EQ(pixels.cols, 2 * 320);
    EXPECT_GT(pixels.rows, 240);
    EXPECT_GT(colouredPixels(pixels), 1000) << "dots of tracks";
  }
}

TEST_F(RunImages, NoTracksAreDrawnUnasked) {
  expectGoodResult(run());
  EXPECT_FALSE(std::filesystem::exists(output_ / "frames"));
  for (const char* period : {"-1", "nan"}) {
    EXPECT_EQ(run(fmt::format("--draw-tracks {}", period)).exit_code, 2) << period;
  }
}

TEST_F(RunImages, MissingFolderOfImagesIsNamed) {
  std::filesystem::remove_all(recording_.sensor("cam1") / "data");
  const Execution result = run();
  EXPECT_EQ(result.exit_code, 1);
  EXPECT_THAT(result.output, HasSubstr((recording_.sensor("cam1") / "data").string()));
}

TEST_F(RunImages, ImagesWithoutTextureEndInEstimationFailure) {
  for (size_t i = 0; i < recording_.image_names.size(); ++i) {
    for (int camera = 0; camera < 2; ++camera) writeBlankImage(recording_.image(camera, i));
  }
  const Execution result = run();
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_THAT(result.output, AllOf(HasSubstr("estimation failed"), HasSubstr("waiting for")));
  EXPECT_EQ(poses(), 0);
  EXPECT_EQ(summary()["completion"], 0.0);
  // Roll and pitch are known without images.
  const std::string states = readText(output_ / "states.csv");
  EXPECT_EQ(std::count(states.begin(), states.end(), '\n'), kRoomImages + 1);
  EXPECT_THAT(states, HasSubstr(",attitude,0,"));
  EXPECT_THAT(states, HasSubstr(",no_magnetometer,"));
  EXPECT_EQ(poses(), 0);
}

TEST_F(RunImages, EveryImageTwiceIsNamedAndLeavesTheResultAsItIs) {
  for (const char* camera : {"cam0", "cam1"}) {
    editLines(recording_.csv(camera), [](auto& lines) {
      std::vector<std::string> doubled = {lines.front()};
      for (size_t i = 1; i < lines.size(); ++i) {
        const size_t comma = lines[i].find(',');
        const int64_t stamp_ns = std::stoll(lines[i].substr(0, comma));
        doubled.push_back(lines[i]);
        if (i + 1 < lines.size())
          doubled.push_back(fmt::format("{}{}", stamp_ns + 25'000'000, lines[i].substr(comma)));
      }
      lines = doubled;
    });
    replaceText(recording_.sensor(camera) / "sensor.yaml", "rate_hz: 20", "rate_hz: 40");
  }
  const Execution result = run();
  expectGoodResult(result);
  EXPECT_EQ(findings("images_repeated"), 2 * (kRoomImages - 1) + 2) << "one of each camera before the run";
  EXPECT_THAT(result.output, HasSubstr("this run leaves them out"));
}

TEST_F(RunImages, ARightCameraThatHangsIsNamedWithItsTimeAndLeftOut) {
  for (size_t i = 11; i < 21; ++i) {
    std::filesystem::copy_file(recording_.image(1, 10), recording_.image(1, i),
                               std::filesystem::copy_options::overwrite_existing);
  }
  const Execution result = run();
  expectGoodResult(result);
  EXPECT_EQ(findings("images_frozen"), 1);
  EXPECT_THAT(result.output, HasSubstr("cam1: frozen from 0:00.550 to 0:01.000"));
}

TEST_F(RunImages, ExchangedCalibrationsOfLeftAndRightAreNamedAndUndone) {
  const std::filesystem::path left = recording_.sensor("cam0") / "sensor.yaml";
  const std::filesystem::path right = recording_.sensor("cam1") / "sensor.yaml";
  std::filesystem::rename(left, folder_.path() / "kept.yaml");
  std::filesystem::rename(right, left);
  std::filesystem::rename(folder_.path() / "kept.yaml", right);
  const Execution result = run();
  expectGoodResult(result, kRoomImages - 1);
  EXPECT_GE(findings("cameras_swapped"), 1);
  EXPECT_THAT(result.output, HasSubstr("exchanged"));
}

TEST_F(RunImages, CamerasExchangedInMidRunArePutBack) {
  for (size_t i = 15; i < recording_.image_names.size(); ++i) {
    const std::filesystem::path kept = folder_.path() / "kept.png";
    std::filesystem::rename(recording_.image(0, i), kept);
    std::filesystem::rename(recording_.image(1, i), recording_.image(0, i));
    std::filesystem::rename(kept, recording_.image(1, i));
  }
  const Execution result = run();
  expectGoodResult(result);
  EXPECT_EQ(findings("cameras_swapped"), 1);
  EXPECT_THAT(result.output, HasSubstr("stamp 0:00.750"));
}

TEST_F(RunImages, AMissingListOfTheRightCameraIsMadeFromTheNamesOfItsImages) {
  std::filesystem::remove(recording_.csv("cam1"));
  const Execution result = run();
  expectGoodResult(result);
  EXPECT_EQ(findings("image_list_made"), 1);
  EXPECT_THAT(result.output, HasSubstr("cam1/data.csv: missing"));
}

TEST_F(RunImages, OtherSizesFromMidRunOnAreNamedAndBridged) {
  for (size_t i = 15; i < recording_.image_names.size(); ++i) {
    cv::imwrite(recording_.image(1, i).string(), cv::Mat(120, 160, CV_8UC1, cv::Scalar(90)));
  }
  const Execution result = run();
  expectGoodResult(result);
  EXPECT_EQ(findings("image_size"), kRoomImages - 15 + 1) << "one of them before the run";
  EXPECT_EQ(findings("one_camera"), 1) << "the second half hangs on the left camera";
}

}  // namespace
}  // namespace lodeline::test
