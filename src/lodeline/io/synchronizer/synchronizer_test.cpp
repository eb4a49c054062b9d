#include "lodeline/io/synchronizer/synchronizer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "lodeline/diagnostics.h"
#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/io/euroc/test_recording.h"

namespace lodeline {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

class SynchronizerTest : public testing::Test {
 protected:
  std::vector<FramePacket> readAll(const SynchronizerOptions& options = {}, const EurocOptions& euroc = {}) {
    EurocSource source(recording_.folder(), euroc, &diagnostics_);
    Synchronizer synchronizer(&source, options, &diagnostics_);
    std::vector<FramePacket> packets;
    while (std::optional<FramePacket> packet = synchronizer.next()) packets.push_back(std::move(*packet));
    return packets;
  }

  std::string firstMessage(const std::string& kind) {
    for (const Finding& finding : diagnostics_.ranked()) {
      if (finding.kind == kind) return finding.first_message;
    }
    return "no finding of kind " + kind;
  }

  /// Removes the rows with stamps in [from_s, to_s].
  void removeRows(const std::string& csv, double from_s, double to_s) {
    std::istringstream text(recording_.read(csv));
    std::string kept;
    for (std::string line; std::getline(text, line);) {
      const bool inside = line >= testStamp(from_s) && line.substr(0, 19) <= testStamp(to_s);
      if (!inside) kept += line + '\n';
    }
    recording_.write(csv, kept);
  }

  TestRecording recording_;
  Diagnostics diagnostics_;
};

TEST_F(SynchronizerTest, GivesOneCompletePacketPerImage) {
  const std::vector<FramePacket> packets = readAll();
  ASSERT_EQ(packets.size(), 21u);
  EXPECT_TRUE(diagnostics_.ranked().empty());
  for (size_t i = 0; i < packets.size(); ++i) {
    const FramePacket& packet = packets[i];
    EXPECT_EQ(packet.time, testTime(1.0 + 0.05 * static_cast<double>(i)));
    EXPECT_EQ(packet.image_stamp, packet.time);
    ASSERT_EQ(packet.images.size(), 2u);
    EXPECT_EQ(packet.images[0].at<uint8_t>(0, 0), i);
    EXPECT_EQ(packet.images[1].at<uint8_t>(0, 0), 10 + i);
    EXPECT_EQ(packet.imu.back().time, packet.time);
    EXPECT_NEAR(packet.longest_imu_gap_s, 0.005, 1e-12);
    EXPECT_EQ(packet.imu.size(), i == 0 ? 101u : 11u);
    for (const MagnetometerSample& sample : packet.readings.of<MagnetometerSample>()) {
      EXPECT_LE(sample.time, packet.time);
      EXPECT_TRUE(i == 0 || sample.time > packets[i - 1].time);
    }
  }
  EXPECT_EQ(packets[0].readings.of<MagnetometerSample>().size(), 26u);
  EXPECT_EQ(packets[1].readings.of<MagnetometerSample>().size(), 2u);
  EXPECT_EQ(packets[2].readings.of<MagnetometerSample>().size(), 3u);
}

TEST_F(SynchronizerTest, MovesCameraStampsToTheImuClock) {
  recording_.write("cam0/sensor.yaml", recording_.read("cam0/sensor.yaml") + "timeshift_cam_imu: 0.002\n");
  recording_.write("cam1/sensor.yaml", recording_.read("cam1/sensor.yaml") + "timeshift_cam_imu: 0.003\n");
  const std::vector<FramePacket> packets = readAll();
  ASSERT_EQ(packets.size(), 21u);
  EXPECT_EQ(packets[3].time, testTime(1.152));
  EXPECT_EQ(packets[3].image_stamp, testTime(1.15));
  EXPECT_FALSE(packets[3].images[1].empty());
  EXPECT_EQ(packets[3].imu.front().time, testTime(1.102));
  EXPECT_EQ(packets[3].imu.back().time, testTime(1.152));
  EXPECT_NEAR(packets[3].imu.back().angular_velocity_B.x(), 1.152, 1e-9);
}

TEST_F(SynchronizerTest, MovesMagnetometerStampsToTheImuClock) {
  const std::vector<FramePacket> packets = readAll();
  EurocSource source(recording_.folder(), {}, &diagnostics_);
  MagnetometerCalibration magnetometer = *source.rig().magnetometer;
  magnetometer.time_offset_to_imu_s = -0.015;
  source.setMagnetometer(magnetometer);
  Synchronizer synchronizer(&source, {}, &diagnostics_);
  const std::optional<FramePacket> late = synchronizer.next();
  ASSERT_TRUE(late);
  EXPECT_EQ(late->readings.of<MagnetometerSample>()[1].time,
            packets[0].readings.of<MagnetometerSample>()[1].time - Duration::fromSeconds(0.015));
  EXPECT_EQ(late->readings.of<MagnetometerSample>()[1].field_M,
            packets[0].readings.of<MagnetometerSample>()[1].field_M);
}

TEST_F(SynchronizerTest, CrlfChangesNothing) {
  for (const char* csv : {"cam0/data.csv", "cam1/data.csv", "imu0/data.csv", "mag0/data.csv"}) {
    std::string crlf;
    for (const char c : recording_.read(csv)) crlf += c == '\n' ? std::string("\r\n") : std::string(1, c);
    recording_.write(csv, crlf);
  }
  EXPECT_EQ(readAll().size(), 21u);
  EXPECT_TRUE(diagnostics_.ranked().empty());
}

TEST_F(SynchronizerTest, FindsImagesWithoutTheFileNameColumn) {
  std::string csv;
  for (int i = 0; i <= 20; ++i) csv += testStamp(1.0 + 0.05 * i) + "\n";
  recording_.write("cam0/data.csv", csv);
  EXPECT_FALSE(readAll()[20].images[0].empty());
}

TEST_F(SynchronizerTest, MissingRowOfAnotherCameraLeavesItsImageEmpty) {
  removeRows("cam1/data.csv", 1.1, 1.1);
  const std::vector<FramePacket> packets = readAll();
  ASSERT_EQ(packets.size(), 21u);
  EXPECT_TRUE(packets[2].images[1].empty());
  EXPECT_FALSE(packets[3].images[1].empty());
  EXPECT_EQ(diagnostics_.count("image_missing"), 1);
  EXPECT_THAT(firstMessage("image_missing"), AllOf(HasSubstr("cam1"), HasSubstr(testStamp(1.1))));
}

TEST_F(SynchronizerTest, MissingRowOfTheFirstCameraIsAGapAndItsPartnerPassedOver) {
  removeRows("cam0/data.csv", 1.1, 1.1);
  const std::vector<FramePacket> packets = readAll();
  EXPECT_EQ(packets.size(), 20u);
  EXPECT_NEAR((packets[2].imu.back().time - packets[2].imu.front().time).seconds(), 0.1, 1e-12);
  EXPECT_EQ(diagnostics_.count("image_gap"), 1);
  EXPECT_EQ(diagnostics_.count("image_without_partner"), 1);
}

TEST_F(SynchronizerTest, MissingOrDamagedImageFileStillGivesAPacket) {
  std::filesystem::remove(recording_.image(0, 1.2));
  std::ofstream(recording_.image(1, 1.3)) << "rubbish";
  const std::vector<FramePacket> packets = readAll();
  ASSERT_EQ(packets.size(), 21u);
  EXPECT_TRUE(packets[4].images[0].empty());
  EXPECT_FALSE(packets[4].images[1].empty());
  EXPECT_TRUE(packets[6].images[1].empty());
  EXPECT_EQ(diagnostics_.count("image_unreadable"), 2);
  EXPECT_THAT(firstMessage("image_unreadable"), HasSubstr(testStamp(1.2) + ".png: image missing"));
}

TEST_F(SynchronizerTest, WrongResolutionNamesFileAndBothSizes) {
  for (int i = 0; i <= 20; ++i) {
    cv::imwrite(recording_.image(1, 1.0 + 0.05 * i).string(), cv::Mat(6, 8, CV_8UC1, cv::Scalar(0)));
  }
  for (const bool prefetch : {false, true}) {
    SynchronizerOptions options;
    options.prefetch = prefetch;
    EXPECT_THAT([&] { readAll(options); },
                ThrowsMessage<InputError>(AllOf(HasSubstr(testStamp(1.0)), HasSubstr("8 x 6"),
                                                HasSubstr("16 x 12"), HasSubstr("source.cameras"))));
  }
}

TEST_F(SynchronizerTest, ImagesOfAnotherSizeAmongOthersAreLeftOut) {
  for (const double time_s : {1.05, 1.6, 1.65, 1.7, 1.75, 1.8, 1.85, 1.9, 1.95, 2.0}) {
    cv::imwrite(recording_.image(0, time_s).string(), cv::Mat(6, 8, CV_8UC1, cv::Scalar(0)));
  }
  const std::vector<FramePacket> packets = readAll();
  ASSERT_EQ(packets.size(), 21u);
  EXPECT_FALSE(packets[0].images[0].empty());
  EXPECT_TRUE(packets[1].images[0].empty());
  EXPECT_FALSE(packets[1].images[1].empty());
  EXPECT_TRUE(packets[20].images[0].empty());
  EXPECT_EQ(diagnostics_.count("image_size"), 10);
  EXPECT_THAT(firstMessage("image_size"), HasSubstr(testStamp(1.05)));
}

TEST_F(SynchronizerTest, ARepeatedImageGivesItsReadingsToTheNextPacket) {
  for (int i = 0; i <= 20; ++i) {
    for (const int camera : {0, 1}) {
      cv::Mat image(12, 16, CV_8UC1);
      cv::RNG(static_cast<uint64_t>(1 + 100 * camera + (i == 8 ? 7 : i)))
          .fill(image, cv::RNG::UNIFORM, 0, 256);
      cv::imwrite(recording_.image(camera, 1.0 + 0.05 * i).string(), image);
    }
  }
  const std::vector<FramePacket> packets = readAll();
  ASSERT_EQ(packets.size(), 20u);
  EXPECT_EQ(packets[7].time, testTime(1.35));
  EXPECT_EQ(packets[8].time, testTime(1.45));
  EXPECT_EQ(packets[8].imu.front().time, testTime(1.35));
  EXPECT_EQ(packets[8].imu.size(), 21u);
  for (size_t j = 1; j < packets[8].imu.size(); ++j) {
    EXPECT_LT(packets[8].imu[j - 1].time, packets[8].imu[j].time);
  }
  EXPECT_EQ(packets[8].readings.of<MagnetometerSample>().size(), 5u);
  EXPECT_EQ(diagnostics_.count("images_repeated"), 2) << "of each camera";
}

TEST_F(SynchronizerTest, ImagesOfASecondCameraKeepTheirOwnTimes) {
  recording_.write("cam1/sensor.yaml", recording_.read("cam1/sensor.yaml") + "timeshift_cam_imu: 0.012\n");
  const std::vector<FramePacket> packets = readAll();
  ASSERT_EQ(packets.size(), 21u);
  EXPECT_TRUE(diagnostics_.ranked().empty());
  EXPECT_FALSE(packets[4].images[1].empty());
  ASSERT_EQ(packets[4].image_delays_s.size(), 2u);
  EXPECT_NEAR(packets[4].image_delays_s[1], 0.012, 1e-9);
  EXPECT_EQ(packets[4].imu_ahead.front().time, packets[4].time);
  EXPECT_EQ(packets[4].imu_ahead.back().time, testTime(1.212));
  EXPECT_NEAR(packets[4].imu_ahead.back().angular_velocity_B.x(), 1.212, 1e-9);
  EXPECT_EQ(packets[5].imu.front().time, testTime(1.2));
}

TEST_F(SynchronizerTest, TremblingStampsOfASecondCameraAreNoDelays) {
  std::string list = "#timestamp [ns],filename\n";
  for (int i = 0; i <= 20; ++i) {
    const double time_s = 1.0 + 0.05 * i;
    const double trembling_s = time_s + (i % 3 == 1 ? 2e-3 : i % 3 == 2 ? -1.5e-3 : 0.0);
    list += testStamp(trembling_s) + "," + testStamp(time_s) + ".png\n";
  }
  recording_.write("cam1/data.csv", list);
  const std::vector<FramePacket> packets = readAll();
  ASSERT_EQ(packets.size(), 21u);
  for (size_t i = 2; i < packets.size(); ++i) {
    EXPECT_FALSE(packets[i].images[1].empty());
    EXPECT_EQ(packets[i].image_delays_s[1], 0.0) << i;
  }
}

TEST_F(SynchronizerTest, ImuGapIsBridgedAndReported) {
  removeRows("imu0/data.csv", 1.21, 1.70);
  const std::vector<FramePacket> packets = readAll();
  ASSERT_EQ(packets.size(), 21u);
  EXPECT_EQ(diagnostics_.count("imu_gap"), 1);
  EXPECT_THAT(firstMessage("imu_gap"), AllOf(HasSubstr("0.500 s"), HasSubstr(testStamp(1.205))));
  EXPECT_NEAR(packets[4].longest_imu_gap_s, 0.005, 1e-12);
  for (size_t i = 5; i <= 15; ++i) EXPECT_NEAR(packets[i].longest_imu_gap_s, 0.5, 1e-12) << i;
  EXPECT_NEAR(packets[16].longest_imu_gap_s, 0.005, 1e-12);
  EXPECT_NEAR(packets[10].imu.back().angular_velocity_B.x(), 1.5, 1e-9);
}

TEST_F(SynchronizerTest, ImagesWithoutImuArePassedOver) {
  removeRows("imu0/data.csv", 0.0, 1.12);
  removeRows("imu0/data.csv", 1.88, 3.0);
  const std::vector<FramePacket> packets = readAll();
  ASSERT_EQ(packets.size(), 15u);
  EXPECT_EQ(packets.front().time, testTime(1.15));
  EXPECT_EQ(packets.back().time, testTime(1.85));
  EXPECT_EQ(diagnostics_.count("image_before_imu"), 3);
  EXPECT_EQ(diagnostics_.count("image_after_imu"), 3);
  EXPECT_THAT(firstMessage("image_after_imu"), HasSubstr(testStamp(1.9)));
}

TEST_F(SynchronizerTest, BrokenImuRowsAreReportedAndPassedOver) {
  const std::string stamp = testStamp(1.5) + ",";
  recording_.replace("imu0/data.csv", stamp + "1.500,", stamp + "nan,");
  recording_.write("imu0/data.csv", recording_.read("imu0/data.csv") + testStamp(2.505) + ",2.5,0");
  const std::vector<FramePacket> packets = readAll();
  ASSERT_EQ(packets.size(), 21u);
  EXPECT_EQ(diagnostics_.count("csv_row"), 2);
  EXPECT_NEAR(packets[10].longest_imu_gap_s, 0.010, 1e-12);
  EXPECT_NEAR(packets[10].imu.back().angular_velocity_B.x(), 1.5, 1e-9);
}

TEST_F(SynchronizerTest, TimeGoingBackwardsIsReportedAndPutInOrder) {
  const std::string first = testStamp(1.2) + ",1.200,0,0,0.102,0.2,9.8\n";
  const std::string second = testStamp(1.205) + ",1.205,0,0,0.100,0.2,9.8\n";
  recording_.replace("imu0/data.csv", first + second, second + first + first);
  const std::vector<FramePacket> packets = readAll();
  ASSERT_EQ(packets.size(), 21u);
  // The first of the late readings is sorted in; the second is a duplicate.
  EXPECT_EQ(diagnostics_.count("imu_disorder"), 1);
  EXPECT_EQ(diagnostics_.count("imu_duplicate"), 1);
  EXPECT_THAT(firstMessage("imu_disorder"), HasSubstr(testStamp(1.205)));
  for (const FramePacket& packet : packets) {
    for (size_t j = 1; j < packet.imu.size(); ++j) EXPECT_LT(packet.imu[j - 1].time, packet.imu[j].time);
  }
}

TEST_F(SynchronizerTest, SkipsAndEndsWhereAsked) {
  SynchronizerOptions options;
  options.skip_s = 0.2;
  options.duration_s = 0.3;
  options.history_s = 0.1;
  const std::vector<FramePacket> packets = readAll(options);
  ASSERT_EQ(packets.size(), 7u);
  EXPECT_EQ(packets.front().time, testTime(1.2));
  EXPECT_EQ(packets.front().imu.front().time, testTime(1.1));
  EXPECT_GE(packets.front().readings.of<MagnetometerSample>().front().time, testTime(1.1));
  EXPECT_EQ(diagnostics_.count("image_without_partner"), 0);
}

TEST_F(SynchronizerTest, OneCameraAlone) {
  EurocOptions right_only;
  right_only.camera_indices = {1};
  const std::vector<FramePacket> packets = readAll({}, right_only);
  ASSERT_EQ(packets.size(), 21u);
  ASSERT_EQ(packets[0].images.size(), 1u);
  EXPECT_EQ(packets[0].images[0].at<uint8_t>(0, 0), 10);
}

TEST_F(SynchronizerTest, MissingMagnetometerIsNormal) {
  std::filesystem::remove_all(recording_.path("mag0"));
  EXPECT_TRUE(readAll()[0].readings.of<MagnetometerSample>().empty());
  EXPECT_TRUE(diagnostics_.ranked().empty());
}

TEST_F(SynchronizerTest, MagnetometerInMicroteslaIsPointedOut) {
  for (int row = 0; row < 2; ++row) recording_.replace("mag0/data.csv", "2e-5,0,-4e-5", "20,0,-40");
  readAll();
  EXPECT_EQ(diagnostics_.count("magnetometer_unit"), 1) << "said of the column, not of each row";
  EXPECT_THAT(firstMessage("magnetometer_unit"), HasSubstr("mag0/data.csv:2"));
}

TEST_F(SynchronizerTest, MissingFolderOfImagesIsAnError) {
  std::filesystem::remove_all(recording_.path("cam0/data"));
  EXPECT_THAT([&] { readAll(); },
              ThrowsMessage<InputError>(HasSubstr("cam0/data: folder of images missing")));
}

}  // namespace
}  // namespace lodeline
