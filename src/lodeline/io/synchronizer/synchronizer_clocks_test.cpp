#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "lodeline/diagnostics.h"
#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/io/euroc/test_recording.h"
#include "lodeline/io/synchronizer/synchronizer.h"

namespace lodeline {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// Recordings whose clocks jump or do not overlap. The first gyroscope axis reads the true time in seconds,
/// and the first pixel counts the images: both show their assigned times.
class SynchronizerClocksTest : public testing::Test {
 protected:
  std::vector<FramePacket> readAll() {
    EurocSource source(recording_.folder(), {}, &diagnostics_);
    Synchronizer synchronizer(&source, {}, &diagnostics_);
    std::vector<FramePacket> packets;
    while (std::optional<FramePacket> packet = synchronizer.next()) packets.push_back(std::move(*packet));
    recorded_images_ = synchronizer.recordedImages();
    return packets;
  }

  /// Shifts the stamps of the rows from `from_s` on; the names of images are unchanged.
  void shift(const std::string& sensor, double from_s, double by_s) {
    std::istringstream text(recording_.read(sensor + "/data.csv"));
    std::string rows;
    for (std::string line; std::getline(text, line);) {
      if (line >= testStamp(from_s) && line[0] != '#') {
        const int64_t stamp_ns = std::stoll(line.substr(0, 19)) + std::llround(by_s * 1e9);
        const std::string name = line.size() > 19 ? line.substr(19) : "," + line + ".png";
        line = std::to_string(stamp_ns) + name;
      }
      rows += line + "\n";
    }
    recording_.write(sensor + "/data.csv", rows);
  }

  /// Expects all images in order, with the inertial readings of their true times.
  void expectHealthy(const std::vector<FramePacket>& packets) {
    ASSERT_EQ(packets.size(), 21u);
    for (size_t i = 0; i < packets.size(); ++i) {
      ASSERT_FALSE(packets[i].images[0].empty()) << i;
      ASSERT_FALSE(packets[i].images[1].empty()) << i;
      EXPECT_EQ(packets[i].images[0].at<uint8_t>(0, 0), i);
      EXPECT_NEAR(packets[i].imu.back().angular_velocity_B.x(), 1.0 + 0.05 * static_cast<double>(i), 1e-6)
          << i;
      EXPECT_NEAR(packets[i].longest_imu_gap_s, 0.005, 1e-9) << i;
    }
  }

  std::string only(const std::string& kind) {
    const std::vector<Finding> findings = diagnostics_.ranked();
    return findings.size() == 1 && findings[0].kind == kind ? findings[0].first_message
                                                            : "not only findings of kind " + kind;
  }

  TestRecording recording_;
  Diagnostics diagnostics_;
  int64_t recorded_images_ = 0;
};

TEST_F(SynchronizerClocksTest, ImageClockSetAheadIsTakenBack) {
  for (const double by_s : {3.0, 3600.0, 3e8}) {
    const TestRecording fresh;
    for (const char* sensor : {"cam0", "cam1"}) {
      recording_.write(std::string(sensor) + "/data.csv", fresh.read(std::string(sensor) + "/data.csv"));
      shift(sensor, 1.5, by_s);
    }
    diagnostics_ = {};
    const std::vector<FramePacket> packets = readAll();
    expectHealthy(packets);
    EXPECT_EQ(packets[10].image_stamp, testTime(1.5) + Duration::fromSeconds(by_s));
    EXPECT_EQ(diagnostics_.count("image_clock_jump"), 1) << by_s;
  }
}

TEST_F(SynchronizerClocksTest, ImageClockSetBackIsTakenBack) {
  for (const char* sensor : {"cam0", "cam1"}) shift(sensor, 1.5, -3600.0);
  expectHealthy(readAll());
  EXPECT_EQ(diagnostics_.count("image_clock_jump"), 2);  // each camera's stream
  EXPECT_EQ(diagnostics_.ranked().size(), 1u);
}

TEST_F(SynchronizerClocksTest, ImuClockSetAheadIsTakenBack) {
  for (const double by_s : {2.0, 3600.0, 3e8}) {
    const TestRecording fresh;
    recording_.write("imu0/data.csv", fresh.read("imu0/data.csv"));
    shift("imu0", 1.502, by_s);
    diagnostics_ = {};
    const std::vector<FramePacket> packets = readAll();
    expectHealthy(packets);
    EXPECT_EQ(diagnostics_.count("imu_clock_jump"), 1) << by_s;
  }
}

TEST_F(SynchronizerClocksTest, ImuClockSetBackIsTakenBack) {
  for (const double by_s : {-0.02, -0.1, -3600.0}) {
    const TestRecording fresh;
    recording_.write("imu0/data.csv", fresh.read("imu0/data.csv"));
    shift("imu0", 1.502, by_s);
    diagnostics_ = {};
    expectHealthy(readAll());
    EXPECT_THAT(only("imu_clock_jump"), HasSubstr("set back by")) << by_s;
  }
}

TEST_F(SynchronizerClocksTest, ClockOfAllSensorsSetBackChangesNothingElse) {
  for (const char* sensor : {"cam0", "cam1", "imu0", "mag0"}) shift(sensor, 1.498, -0.5);
  expectHealthy(readAll());
}

TEST_F(SynchronizerClocksTest, ClockOfAllSensorsSetAheadLeavesAShortPause) {
  for (const char* sensor : {"cam0", "cam1", "imu0", "mag0"}) shift(sensor, 1.498, 3600.0);
  const std::vector<FramePacket> packets = readAll();
  ASSERT_EQ(packets.size(), 21u);
  EXPECT_EQ(diagnostics_.count("clock_jump"), 1);
  EXPECT_NEAR((packets[10].time - packets[9].time).seconds(), 1.045, 0.01);
  EXPECT_NEAR((packets[20].time - packets[10].time).seconds(), 0.5, 1e-9);
  EXPECT_FALSE(packets[10].images[1].empty());
  EXPECT_NEAR(packets[20].imu.back().angular_velocity_B.x(), 2.0, 1e-6);
  EXPECT_EQ(packets[20].readings.of<MagnetometerSample>().size(),
            2u + packets[20].readings.of<MagnetometerSample>().size() % 2);
}

TEST_F(SynchronizerClocksTest, PausesAndLostDataAreNoJumps) {
  // A second and a half without images, and half a second without inertial readings while images continue.
  std::istringstream text(recording_.read("imu0/data.csv"));
  std::string rows;
  for (std::string line; std::getline(text, line);) {
    if (line < testStamp(1.2) || line > testStamp(1.7) || line[0] == '#') rows += line + "\n";
  }
  recording_.write("imu0/data.csv", rows);
  EXPECT_EQ(readAll().size(), 21u);
  EXPECT_EQ(diagnostics_.count("imu_gap"), 1);
  EXPECT_EQ(diagnostics_.ranked().size(), 1u);
}

TEST_F(SynchronizerClocksTest, ClocksThatDoNotMeetAreNamedWithBothSpans) {
  shift("imu0", 0.0, -1.4e9);
  EXPECT_TRUE(readAll().empty());
  EXPECT_EQ(recorded_images_, 21);
  ASSERT_EQ(diagnostics_.count("clocks_apart"), 1);
  EXPECT_EQ(diagnostics_.ranked()[0].kind, "clocks_apart");
  EXPECT_THAT(diagnostics_.ranked()[0].first_message,
              AllOf(HasSubstr(testStamp(1.0)), HasSubstr(testStamp(2.0)), HasSubstr("1.4e+09 s earlier")));
  shift("imu0", -1.4e9, 0.0);
}

TEST_F(SynchronizerClocksTest, ClocksThatDoNotMeetAreNamedWhicheverIsLater) {
  for (const char* sensor : {"cam0", "cam1"}) shift(sensor, 0.0, -1.4e9);
  EXPECT_TRUE(readAll().empty());
  ASSERT_EQ(diagnostics_.count("clocks_apart"), 1);
  EXPECT_THAT(diagnostics_.ranked()[0].first_message,
              AllOf(HasSubstr(testStamp(0.5)), HasSubstr(testStamp(2.5)), HasSubstr("later")));
}

TEST_F(SynchronizerClocksTest, ReversedImagesAreRefused) {
  for (const char* sensor : {"cam0", "cam1"}) {
    std::istringstream text(recording_.read(std::string(sensor) + "/data.csv"));
    std::string rows;
    for (std::string line; std::getline(text, line);) rows = line + "\n" + rows;
    recording_.write(std::string(sensor) + "/data.csv", rows);
  }
  EXPECT_THAT([&] { readAll(); },
              testing::ThrowsMessage<InputError>(AllOf(HasSubstr("cam"), HasSubstr("reverse"))));
}

TEST_F(SynchronizerClocksTest, CountsImagesThatCannotBeUsed) {
  shift("imu0", 1.3, 0.0);
  std::istringstream text(recording_.read("imu0/data.csv"));
  std::string rows;
  for (std::string line; std::getline(text, line);) {
    if (line < testStamp(1.42) || line[0] == '#') rows += line + "\n";
  }
  recording_.write("imu0/data.csv", rows);
  EXPECT_EQ(readAll().size(), 9u);
  EXPECT_EQ(recorded_images_, 21);
}

TEST_F(SynchronizerClocksTest, MicrosecondsInAllFilesAreReadAsSuch) {
  for (const char* sensor : {"cam0", "cam1", "imu0", "mag0"}) {
    std::istringstream text(recording_.read(std::string(sensor) + "/data.csv"));
    std::string rows;
    for (std::string line; std::getline(text, line);) {
      if (line[0] == '#') continue;
      const std::string rest = line.size() > 19 ? line.substr(19) : "";
      rows += line.substr(0, 16) + rest + "\n";
    }
    recording_.write(std::string(sensor) + "/data.csv", rows);
  }
  const std::vector<FramePacket> packets = readAll();
  expectHealthy(packets);
  EXPECT_EQ(diagnostics_.count("stamp_unit"), 4);
}

TEST_F(SynchronizerClocksTest, SecondCameraByAnotherClockIsNamedWithTheOffset) {
  for (const double by_s : {3600.0, -3600.0}) {
    const TestRecording fresh;
    recording_.write("cam1/data.csv", fresh.read("cam1/data.csv"));
    shift("cam1", 0.0, by_s);
    diagnostics_ = {};
    EXPECT_EQ(readAll().size(), 21u);
    ASSERT_EQ(diagnostics_.count(kClocksApart), 1) << by_s;
    EXPECT_THAT(diagnostics_.ranked().front().first_message,
                AllOf(HasSubstr("the images of cam1 and those of cam0 have no time in common"),
                      HasSubstr("(3600 s from first to first)"), HasSubstr("timeshift_cam_imu of cam1"),
                      HasSubstr("one of cam0 alone")));
  }
}

TEST_F(SynchronizerClocksTest, SecondCameraWithFewPartnersIsNamed) {
  shift("cam1", 0.0, 0.8);
  EXPECT_EQ(readAll().size(), 21u);
  const std::vector<Finding> findings = diagnostics_.ranked();
  const auto unpaired = std::find_if(findings.begin(), findings.end(), [](const Finding& finding) {
    return finding.kind == "cameras_unpaired";
  });
  ASSERT_NE(unpaired, findings.end());
  EXPECT_THAT(unpaired->first_message,
              AllOf(HasSubstr("cam1: only 5 of 21 images of cam0"), HasSubstr("comes +0.8 s after")));
}

TEST_F(SynchronizerClocksTest, SecondCameraThatPausesIsNotUnpaired) {
  shift("cam1", 1.7, 100.0);
  readAll();
  EXPECT_EQ(diagnostics_.count("cameras_unpaired"), 0);
  EXPECT_EQ(diagnostics_.count(kClocksApart), 0);
}

}  // namespace
}  // namespace lodeline
