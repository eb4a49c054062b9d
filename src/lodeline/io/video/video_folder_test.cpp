#include "lodeline/io/video/video_folder.h"

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/io/film/film_reader.h"
#include "lodeline/io/film/test_film.h"
#include "lodeline/io/video/video_source.h"

// Films of phones with tables of readings. The clock of the stamps starts at 5000 s.

namespace lodeline {
namespace {

using ::testing::HasSubstr;

constexpr int64_t kStart_ns = 5'000'000'000'000;

std::string stamps(const std::string& header, int count, int64_t per_count = 1) {
  std::string text = header;
  for (int i = 0; i < count; ++i)
    text += fmt::format("{}\n", (kStart_ns + i * 1'000'000'000LL / 30) / per_count);
  return text;
}

/// Rows of a table: `row` gets the time in ns and in s since the start.
template <typename Row>
std::string rows(const std::string& header, double rate_hz, const Row& row) {
  std::string text = header;
  for (int i = 0; i < static_cast<int>(1.2 * rate_hz); ++i) {
    const double t = i / rate_hz - 0.1;
    text += row(kStart_ns + std::llround(1e9 * t), t) + "\n";
  }
  return text;
}

class VideoFolderTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!canReadFilms()) GTEST_SKIP() << "built without FFmpeg";
  }
  void writeFilm(const std::string& name) {
    folder_.write(name, "");
    test::writeFilm(folder_.path(name), test::TestFilm());
  }

  void expectReadings(const std::filesystem::path& data, const std::string& program) {
    const std::optional<VideoFolder> found = findVideoFolder(data);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->program, program);
    VideoOptions options;
    options.needs_calibration = false;
    Diagnostics diagnostics;
    VideoSource source(data, options, &diagnostics);
    int images = 0;
    while (const std::optional<PendingImage> image = source.nextImage(0)) {
      EXPECT_NEAR(image->time.seconds(), 5000.0 + images++ / 30.0, 2e-3);
    }
    EXPECT_EQ(images, 30);
    EXPECT_NEAR(source.rig().cameras[0].rate_hz, 30.0, 0.5);
    EXPECT_NEAR(source.rig().imu.rate_hz, 100.0, 1.0);
    int readings = 0;
    while (const std::optional<ImuSample> sample = source.nextImu()) {
      EXPECT_NEAR(sample->angular_velocity_B.x(), sample->time.seconds() - 5000.0, 1e-4);
      EXPECT_NEAR(sample->angular_velocity_B.z(), 0.3, 1e-6);
      EXPECT_NEAR(sample->specific_force_B.y(), 9.8, 1e-6);
      ++readings;
    }
    EXPECT_GT(readings, 110);
    EXPECT_EQ(diagnostics.count("csv_row"), 0);
  }

  test::FilmFolder folder_;
};

TEST_F(VideoFolderTest, ReadsMobileArSensorLogger) {
  writeFilm("movie.mp4");
  folder_.write("frame_timestamps.txt", stamps("Frame timestamp[nanosec]\n", 30));
  folder_.write(
      "gyro_accel.csv",
      rows("Timestamp[nanosec], gx[rad/s], gy[rad/s], gz[rad/s], ax[m/s^2], ay[m/s^2], az[m/s^2]\n", 100.0,
           [](int64_t ns, double t) { return fmt::format("{}, {}, 0, 0.3, 0, 9.8, 0", ns, t); }));
  expectReadings(folder_.path(), "Mobile AR Sensor Logger");
  expectReadings(folder_.path("movie.mp4"), "Mobile AR Sensor Logger");
}

TEST_F(VideoFolderTest, ReadsOpenCameraSensors) {
  writeFilm("VID_20210204_205142.mp4");
  const std::string name = "20210204_205142/VID_20210204_205142_";
  folder_.write(name + "timestamps.csv", stamps("", 30));
  folder_.write(name + "gyro.csv",
                rows("", 100.0, [](int64_t ns, double t) { return fmt::format("{},0.0,0.3,{}", t, ns); }));
  folder_.write(name + "accel.csv",
                rows("", 50.0, [](int64_t ns, double) { return fmt::format("0.0,9.8,0.0,{}", ns); }));
  folder_.write(name + "magnetic.csv",
                rows("", 25.0, [](int64_t ns, double) { return fmt::format("20.0,0.0,-40.0,{}", ns); }));
  expectReadings(folder_.path("VID_20210204_205142.mp4"), "OpenCamera Sensors");
  expectReadings(folder_.path(), "OpenCamera Sensors");
  VideoOptions options;
  options.needs_calibration = false;
  Diagnostics diagnostics;
  VideoSource source(folder_.path("VID_20210204_205142.mp4"), options, &diagnostics);
  EXPECT_NEAR(source.nextMagnetometer()->field_M.z(), -40e-6, 1e-12);
}

TEST_F(VideoFolderTest, ReadsSensorLogger) {
  writeFilm("Camera/video.mp4");
  folder_.write("timestamps.csv", stamps("time\n", 30));
  const auto elapsed = [](double t) { return fmt::format("{:.4f}", t + 1.0); };
  folder_.write("Gyroscope.csv", rows("time,seconds_elapsed,z,y,x\n", 100.0, [&](int64_t ns, double t) {
                  return fmt::format("{},{},0.3,0,{}", ns, elapsed(t), t);
                }));
  folder_.write("TotalAcceleration.csv",
                rows("time,seconds_elapsed,z,y,x\n", 100.0,
                     [&](int64_t ns, double t) { return fmt::format("{},{},0,9.8,0", ns, elapsed(t)); }));
  // Without gravity; must not be taken.
  folder_.write("Accelerometer.csv", "time,seconds_elapsed,z,y,x\n1,1,0,0,0\n");
  expectReadings(folder_.path(), "Sensor Logger");
}

TEST_F(VideoFolderTest, TellsFewerStampsThanImages) {
  writeFilm("movie.mp4");
  folder_.write("frame_timestamps.txt", stamps("", 20));
  folder_.write("gyro_accel.csv",
                rows("t [ns],gx [rad/s],gy [rad/s],gz [rad/s],ax [m/s^2],ay [m/s^2],az [m/s^2]\n", 100.0,
                     [](int64_t ns, double) { return fmt::format("{},0,0,0,0,9.8,0", ns); }));
  VideoOptions options;
  options.needs_calibration = false;
  Diagnostics diagnostics;
  VideoSource source(folder_.path(), options, &diagnostics);
  int images = 0;
  while (source.nextImage(0)) ++images;
  EXPECT_EQ(images, 20);
  EXPECT_EQ(diagnostics.count("video_stamps"), 1);
}

TEST_F(VideoFolderTest, IsNoneWithoutTables) {
  writeFilm("movie.mp4");
  EXPECT_FALSE(findVideoFolder(folder_.path()));
  folder_.write("frame_timestamps.txt", stamps("", 30));
  EXPECT_FALSE(findVideoFolder(folder_.path()));
  EXPECT_FALSE(findVideoFolder(folder_.path("absent")));
}

}  // namespace
}  // namespace lodeline
