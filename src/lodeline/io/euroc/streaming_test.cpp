#include <gtest/gtest.h>
#include <unistd.h>
#include <cmath>

#include <algorithm>
#include <fstream>

#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/io/euroc/test_recording.h"
#include "lodeline/io/synchronizer/synchronizer.h"

namespace lodeline {
namespace {

/// Half an hour at 200 Hz (IMU) and 15 Hz (images of 2 x 2 px), generated on demand. Counts the readings
/// pulled in advance.
class LongSource : public MeasurementSource {
 public:
  LongSource() {
    CameraCalibration camera;
    camera.name = "cam0";
    camera.width_px = 2;
    camera.height_px = 2;
    camera.rate_hz = 15.0;
    rig_.cameras = {camera, camera};
    rig_.magnetometer.emplace();
  }
  const Rig& rig() const override { return rig_; }
  std::optional<ImuSample> nextImu() override {
    if (imu_count >= 1800 * 200) return std::nullopt;
    ImuSample sample;
    // Changing values, because a sensor with constant readings would be rejected as stuck.
    const double phase = 0.05 * static_cast<double>(imu_count);
    sample.angular_velocity_B = Vec3(0.1 * std::sin(phase), 0.1 * std::cos(phase), 0.02);
    sample.specific_force_B = Vec3(0.2 * std::cos(phase), 0.1, 9.8 + 0.1 * std::sin(phase));
    sample.time = Time::fromNanoseconds(imu_count++ * 5'000'000);
    return sample;
  }
  std::optional<MagnetometerSample> nextMagnetometer() override {
    if (magnetometer_count >= 1800 * 100) return std::nullopt;
    return MagnetometerSample{Time::fromNanoseconds(magnetometer_count++ * 10'000'000), Vec3(2e-5, 0, 0)};
  }
  /// A different image for each moment, because equal images would be left out as repeats.
  static cv::Mat pattern(int64_t moment) {
    cv::Mat image(2, 2, CV_8UC1);
    for (int i = 0; i < 4; ++i) {
      image.data[i] = static_cast<uint8_t>((moment * 37 * (i + 1)) % 251);
    }
    return image;
  }
  std::optional<PendingImage> nextImage(size_t camera) override {
    int64_t& count = image_count[camera];
    // The images start after a minute, so that a history must be kept and cut.
    const Time time = Time::fromNanoseconds(60'000'000'000 + count * 66'666'667);
    // At the end of the images, the remaining readings are read at once.
    if (time.seconds() > 1799.95) return std::nullopt;
    ++count;
    return PendingImage{time, "made up", [count] { return LoadedImage{pattern(count), ""}; }};
  }

  int64_t imu_count = 0;
  int64_t magnetometer_count = 0;
  int64_t image_count[2] = {0, 0};

 private:
  Rig rig_;
};

/// Resident memory of this process as reported by Linux.
double residentMegabytes() {
  std::ifstream statm("/proc/self/statm");
  double total_pages = 0.0, resident_pages = 0.0;
  statm >> total_pages >> resident_pages;
  return resident_pages * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

TEST(Streaming, ReadingALongCsvHoldsOneRow) {
  const TestRecording recording;
  constexpr int kRows = 1800 * 200;
  {
    std::ofstream csv(recording.path("imu0/data.csv"));
    csv << "#timestamp [ns],w_x,w_y,w_z,a_x,a_y,a_z\n";
    for (int i = 0; i < kRows; ++i) {
      csv << testTime(0.005 * i).nanoseconds()
          << ",-0.0991347015,0.1473057889,0.0272271363,8.14,-0.37,-2.40\n";
    }
  }
  const double file_megabytes =
      static_cast<double>(std::filesystem::file_size(recording.path("imu0/data.csv"))) / 1e6;
  ASSERT_GT(file_megabytes, 20.0);
  Diagnostics diagnostics;
  EurocSource source(recording.folder(), {}, &diagnostics);
  const double before = residentMegabytes();
  int rows = 0;
  while (source.nextImu()) ++rows;
  EXPECT_EQ(rows, kRows);
  EXPECT_LT(residentMegabytes() - before, 2.0);
}

class StreamingBounds : public testing::TestWithParam<bool> {};

TEST_P(StreamingBounds, HalfAnHourNeedsNoMoreMemoryThanAMinute) {
  SynchronizerOptions options;
  options.prefetch = GetParam();
  LongSource source;
  Diagnostics diagnostics;
  Synchronizer synchronizer(&source, options, &diagnostics);
  // Prefetching is one packet ahead: a fifteenth of a second.
  const int64_t packets_ahead = options.prefetch ? 1 : 0;
  int64_t packets = 0;
  size_t most_held = 0;
  while (const std::optional<FramePacket> packet = synchronizer.next()) {
    ++packets;
    // Readings pulled and not yet returned: those after the image time.
    const int64_t imu_due = packet->time.nanoseconds() / 5'000'000 + 1;
    const int64_t magnetometer_due = packet->time.nanoseconds() / 10'000'000 + 1;
    EXPECT_LE(source.imu_count - imu_due, 3 + 14 * packets_ahead);
    EXPECT_LE(source.magnetometer_count - magnetometer_due, 2 + 7 * packets_ahead);
    EXPECT_LE(source.image_count[0] - packets, 2 + packets_ahead);
    EXPECT_LE(source.image_count[1] - packets, 2 + packets_ahead);
    EXPECT_LE(packet->imu.size(), packets == 1 ? 2010u : 20u);
    EXPECT_LE(packet->readings.of<MagnetometerSample>().size(), packets == 1 ? 1010u : 10u);
    most_held = std::max(most_held, synchronizer.bufferedReadings());
  }
  EXPECT_GT(packets, 26'000);
  EXPECT_LE(most_held, 5u);
  EXPECT_TRUE(diagnostics.ranked().empty());
}

INSTANTIATE_TEST_SUITE_P(Prefetching, StreamingBounds, testing::Bool());

}  // namespace
}  // namespace lodeline
