#include "lodeline/io/video/video_source.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/core.hpp>

#include "lodeline/diagnostics.h"
#include "lodeline/io/film/test_film.h"
#include "lodeline/io/video/gpmf/test_gpmf.h"
#include "lodeline/io/video/video_text.h"

namespace lodeline {
namespace {

using test::TestFilm;
using test::TestSensor;
using ::testing::HasSubstr;

constexpr const char* kRig = R"(cam0:
  T_BS: {cols: 4, rows: 4, data: [0, 0, 1, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 0, 1]}
  resolution: [WIDTH, HEIGHT]
  camera_model: pinhole
  intrinsics: [50, 50, 32, 24]
  distortion_model: radial-tangential
  distortion_coefficients: [0, 0, 0, 0]
imu0:
  gyroscope_noise_density: 1.0e-3
  gyroscope_random_walk: 1.0e-5
  accelerometer_noise_density: 1.0e-2
  accelerometer_random_walk: 1.0e-4
)";

std::string rigOf(int width_px, int height_px) {
  std::string text = kRig;
  text.replace(text.find("WIDTH"), 5, std::to_string(width_px));
  text.replace(text.find("HEIGHT"), 6, std::to_string(height_px));
  return text;
}

/// A gyroscope whose first body axis reads the time, and an accelerometer that reads gravity along z, both
/// stored as HERO7 does: Y, -X, Z.
std::vector<TestSensor> sensors() {
  TestSensor gyroscope{"GYRO", "rad/s", "YxZ", 197.3, 0.010, 3000};
  gyroscope.stored = [](double t) { return Vec3(0.5, -t, 0.0); };
  TestSensor accelerometer{"ACCL", "m/s\xb2", "YxZ", 101.9, 0.004, 500};
  accelerometer.stored = [](double t) { return Vec3(0.1 * t, 0.0, 9.8); };
  return {gyroscope, accelerometer};
}

class VideoSourceTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!canReadFilms()) GTEST_SKIP() << "built without FFmpeg";
  }

  static TestFilm filmWith(const std::vector<test::Bytes>& payloads) {
    TestFilm film;
    film.images = 30 * static_cast<int>(payloads.size());
    for (size_t i = 0; i < payloads.size(); ++i)
      film.telemetry.push_back({static_cast<double>(i), 1.0, payloads[i]});
    return film;
  }

  std::filesystem::path write(const std::string& name, const TestFilm& film) {
    test::writeFilm(folder_.path(name), film);
    return folder_.path(name);
  }

  VideoSource open(const std::filesystem::path& film, VideoOptions options = {}) {
    if (options.rig_files.empty()) {
      folder_.write("rig.yaml", rigOf(64, 48));
      options.rig_files = {folder_.path("rig.yaml")};
    }
    return VideoSource(film, options, &diagnostics_);
  }

  std::string refusalOf(const std::filesystem::path& film, const VideoOptions& options = {}) {
    try {
      open(film, options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  test::FilmFolder folder_;
  Diagnostics diagnostics_;
};

TEST_F(VideoSourceTest, GivesReadingsInBodyAxesAtTheirTimes) {
  VideoSource source = open(write("a.mp4", filmWith(test::payloadsOf(sensors(), 6))));
  EXPECT_NEAR(source.rig().imu.rate_hz, 197.3, 0.5);
  EXPECT_NEAR(source.rig().cameras[0].rate_hz, 30.0, 0.01);
  int count = 0;
  Time last;
  while (const std::optional<ImuSample> sample = source.nextImu()) {
    // The first axis reads the true time: the delay of the hand-over is at most a period of the sensor.
    EXPECT_NEAR(sample->angular_velocity_B.x(), sample->time.seconds(), 0.006);
    EXPECT_NEAR(sample->angular_velocity_B.y(), 0.5, 1e-3);
    EXPECT_NEAR(sample->specific_force_B.y(), 0.1 * sample->time.seconds(), 0.005);
    EXPECT_NEAR(sample->specific_force_B.z(), 9.8, 2e-3);
    if (count > 0) {
      EXPECT_NEAR((sample->time - last).seconds(), 1.0 / 197.3, 1e-5);
    }
    last = sample->time;
    ++count;
  }
  EXPECT_GT(count, 1170);
  EXPECT_LE(count, 1184);
  EXPECT_TRUE(diagnostics_.ranked().empty()) << diagnostics_.ranked().front().first_message;
}

TEST_F(VideoSourceTest, GivesTheImagesAtTheirTimes) {
  VideoSource source = open(write("a.mp4", filmWith(test::payloadsOf(sensors(), 2))));
  std::vector<PendingImage> images;
  while (std::optional<PendingImage> image = source.nextImage(0)) images.push_back(std::move(*image));
  ASSERT_EQ(images.size(), 60U);
  for (size_t i = 0; i < images.size(); ++i) {
    EXPECT_NEAR(images[i].time.seconds(), static_cast<double>(i) / 30.0, 1e-4);
    const LoadedImage loaded = images[i].load();
    ASSERT_FALSE(loaded.image.empty()) << loaded.problem;
    EXPECT_NEAR(cv::mean(loaded.image)[0], test::greyOfImage(static_cast<int>(i)), 2.0);
  }
  EXPECT_NE(images[3].name, images[4].name);
}

TEST_F(VideoSourceTest, UsesTheStampsOfTheCamera) {
  std::vector<TestSensor> stamped = sensors();
  for (TestSensor& sensor : stamped) sensor.clock_s = 10.05;
  // One reading an image; its stamps tie the clock of the camera to that of the images.
  stamped.push_back({"SHUT", "s", "", 30.0, 0.0, 1000});
  stamped.back().clock_s = 10.05;
  VideoSource source = open(write("a.mp4", filmWith(test::payloadsOf(stamped, 6))));
  while (const std::optional<ImuSample> sample = source.nextImu()) {
    EXPECT_NEAR(sample->angular_velocity_B.x(), sample->time.seconds(), 0.0005);
  }
}

TEST_F(VideoSourceTest, FollowsTheEditList) {
  TestFilm film = filmWith(test::payloadsOf(sensors(), 4));
  film.images_start_s = 0.5;
  film.images = 100;
  VideoSource source = open(write("a.mp4", film));
  EXPECT_NEAR(source.nextImage(0)->time.seconds(), 0.5, 1e-3);
  const std::optional<ImuSample> sample = source.nextImu();
  EXPECT_NEAR(sample->angular_velocity_B.x(), sample->time.seconds(), 0.006);
}

TEST_F(VideoSourceTest, JoinsChapters) {
  const std::vector<test::Bytes> payloads = test::payloadsOf(sensors(), 6);
  for (int chapter = 0; chapter < 3; ++chapter) {
    const auto first = payloads.begin() + 2 * chapter;
    write("GX0" + std::to_string(chapter + 1) + "0042.MP4", filmWith({first, first + 2}));
  }
  VideoSource source = open(folder_.path("GX010042.MP4"));
  EXPECT_EQ(source.chapters().size(), 3U);
  int images = 0;
  while (const std::optional<PendingImage> image = source.nextImage(0)) {
    EXPECT_NEAR(image->time.seconds(), images++ / 30.0, 1e-3);
    if (images == 61) {
      EXPECT_NEAR(cv::mean(image->load().image)[0], test::greyOfImage(0), 2.0);
    }
  }
  EXPECT_EQ(images, 180);
  double last_s = 0.0;
  while (const std::optional<ImuSample> sample = source.nextImu()) {
    EXPECT_NEAR(sample->angular_velocity_B.x(), sample->time.seconds(), 0.006);
    last_s = sample->time.seconds();
  }
  EXPECT_GT(last_s, 5.9);
  EXPECT_TRUE(diagnostics_.ranked().empty()) << diagnostics_.ranked().front().first_message;
}

TEST_F(VideoSourceTest, LeavesOutADamagedPayloadAndKeepsTheTimes) {
  std::vector<test::Bytes> payloads = test::payloadsOf(sensors(), 6);
  payloads[2].resize(payloads[2].size() / 3);
  VideoSource source = open(write("a.mp4", filmWith(payloads)));
  int count = 0;
  while (const std::optional<ImuSample> sample = source.nextImu()) {
    EXPECT_NEAR(sample->angular_velocity_B.x(), sample->time.seconds(), 0.006);
    ++count;
  }
  EXPECT_GT(count, 900);
  EXPECT_LT(count, 1000);
  EXPECT_GE(diagnostics_.count("telemetry_damaged"), 1);
  EXPECT_GE(diagnostics_.count("telemetry_lost"), 1);
}

TEST_F(VideoSourceTest, TellsAFilmThatIsCutOff) {
  TestFilm film = filmWith(test::payloadsOf(sensors(), 4));
  film.index_first = true;
  film.codec = "mjpeg";
  const std::filesystem::path file = write("a.mov", film);
  std::filesystem::resize_file(file, std::filesystem::file_size(file) * 6 / 10);
  VideoSource source = open(file);
  int images = 0, unreadable = 0;
  while (const std::optional<PendingImage> image = source.nextImage(0)) {
    ++images;
    if (image->load().image.empty()) ++unreadable;
  }
  EXPECT_LT(images, 110);
  EXPECT_GT(images, 20);
  EXPECT_LE(unreadable, 1);
  EXPECT_GE(diagnostics_.count("video_cut_off"), 1);
}

TEST_F(VideoSourceTest, ScalesToTheRig) {
  folder_.write("half.yaml", rigOf(32, 24));
  VideoOptions options;
  options.rig_files = {folder_.path("half.yaml")};
  VideoSource source = open(write("a.mp4", filmWith(test::payloadsOf(sensors(), 2))), options);
  EXPECT_EQ(source.nextImage(0)->load().image.size(), cv::Size(32, 24));
  EXPECT_EQ(diagnostics_.count("video_scaled"), 1);
}

TEST_F(VideoSourceTest, RefusesARigOfOtherImages) {
  const std::filesystem::path film = write("a.mp4", filmWith(test::payloadsOf(sensors(), 2)));
  VideoOptions options;
  for (const auto& [width, height] : {std::pair(64, 36), std::pair(128, 96)}) {
    folder_.write("other.yaml", rigOf(width, height));
    options.rig_files = {folder_.path("other.yaml")};
    EXPECT_THAT(refusalOf(film, options), HasSubstr("the film has 64 x 48 px, the rig describes"));
  }
}

TEST_F(VideoSourceTest, RefusesFilmsWithoutReadings) {
  EXPECT_THAT(refusalOf(write("plain.mp4", TestFilm())), HasSubstr("has no inertial readings"));
  std::vector<TestSensor> gyroscope = {sensors()[0]};
  EXPECT_THAT(refusalOf(write("gyro.mp4", filmWith(test::payloadsOf(gyroscope, 2)))),
              HasSubstr("has no inertial readings"));
  VideoOptions options;
  options.needs_calibration = false;
  EXPECT_EQ(refusalOf(folder_.path("plain.mp4"), options), "no error");
}

TEST_F(VideoSourceTest, RefusesAnUnknownUnit) {
  std::vector<TestSensor> odd = sensors();
  odd[0].unit = "turns/s";
  EXPECT_THAT(refusalOf(write("a.mp4", filmWith(test::payloadsOf(odd, 2)))), HasSubstr("unit 'turns/s'"));
}

TEST_F(VideoSourceTest, ConvertsUnits) {
  std::vector<TestSensor> other = sensors();
  other[0].unit = "deg/s";
  other[1].unit = "g";
  VideoSource source = open(write("a.mp4", filmWith(test::payloadsOf(other, 2))));
  const std::optional<ImuSample> sample = source.nextImu();
  EXPECT_NEAR(sample->angular_velocity_B.y(), 0.5 * M_PI / 180.0, 1e-4);
  EXPECT_NEAR(sample->specific_force_B.z(), 9.8 * 9.80665, 0.1);
}

TEST_F(VideoSourceTest, ReadsAMagnetometerWhereTheRigHasOne) {
  std::vector<TestSensor> all = sensors();
  all.push_back({"MAGN", "\xb5T", "", 24.0, 0.0, 100});
  all.back().stored = [](double) { return Vec3(20.0, 5.0, -40.0); };
  const std::filesystem::path film = write("a.mp4", filmWith(test::payloadsOf(all, 4, "GoPro Max")));
  EXPECT_FALSE(open(film).nextMagnetometer());
  folder_.write("mag.yaml", rigOf(64, 48) +
                                "mag0:\n  T_BS: {cols: 4, rows: 4, data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, "
                                "0, 0, 0, 0, 1]}\n  magnetometer_noise_density: 1.0e-7\n");
  VideoOptions options;
  options.rig_files = {folder_.path("mag.yaml")};
  VideoSource source = open(film, options);
  const std::optional<MagnetometerSample> sample = source.nextMagnetometer();
  ASSERT_TRUE(sample);
  EXPECT_NEAR((sample->field_M - Vec3(-5e-6, 20e-6, -40e-6)).norm(), 0.0, 1e-8);  // YxZ of the model
  EXPECT_NEAR(source.rig().magnetometer->rate_hz, 24.0, 0.2);
}

TEST_F(VideoSourceTest, TellsAxesThatNothingStates) {
  std::vector<TestSensor> unknown = sensors();
  for (TestSensor& sensor : unknown) sensor.stored_axes.clear();
  open(write("a.mp4", filmWith(test::payloadsOf(unknown, 2, "Camera"))));
  EXPECT_EQ(diagnostics_.count("telemetry_axes"), 2);
}

TEST_F(VideoSourceTest, DescribesWhatTheContainerStates) {
  const std::string text = videoText(open(write("a.mp4", filmWith(test::payloadsOf(sensors(), 3)))));
  EXPECT_THAT(text, HasSubstr("64 x 48 px, mpeg4, 90 in the index, 30.0000 Hz, 0.0000 to 3.0000 s"));
  EXPECT_THAT(text, HasSubstr("3 payloads in the index"));
  EXPECT_THAT(text, HasSubstr("ORIN YxZ"));
  // Three payloads tell the rate, 197.3 Hz, to a sample a second.
  EXPECT_THAT(text, testing::ContainsRegex("GYRO +589 +589 +19[678]\\."));
}

}  // namespace
}  // namespace lodeline
