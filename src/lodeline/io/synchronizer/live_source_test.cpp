#include "lodeline/recording.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <future>
#include <opencv2/core.hpp>
#include <thread>

#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/io/euroc/test_recording.h"
#include "lodeline/io/synchronizer/synchronizer.h"

namespace lodeline {
namespace {

/// IMU at 200 Hz, cameras at 20 Hz with images of 2 x 2 px that contain their number, arbitrary calibration.
class LiveSourceTest : public testing::Test {
 protected:
  static Rig rigOf(size_t cameras, bool with_magnetometer) {
    Rig rig;
    for (size_t i = 0; i < cameras; ++i) {
      CameraCalibration camera;
      camera.name = "cam" + std::to_string(i);
      camera.width_px = 2;
      camera.height_px = 2;
      rig.cameras.push_back(camera);
    }
    if (with_magnetometer) rig.magnetometer.emplace();
    return rig;
  }
  static Time at(double seconds) { return testTime(seconds); }

  void pushImu(double from_s, double to_s) {
    for (int64_t ms = std::llround(from_s * 1e3); ms < std::llround(to_s * 1e3); ms += 5) {
      ImuSample sample;
      const double time_s = 1e-3 * static_cast<double>(ms);
      sample.time = at(time_s);
      // Changing values, because a sensor with constant readings would be rejected as stuck.
      sample.angular_velocity_B = 0.1 * Vec3(std::sin(5.0 * time_s), std::cos(5.0 * time_s), 0.3);
      sample.specific_force_B = Vec3(0.2 * std::sin(3.0 * time_s), 0.0, 9.8 + 0.1 * std::cos(3.0 * time_s));
      source_->push(sample);
    }
  }
  void pushImage(size_t camera, double time_s) {
    source_->push(camera, {at(time_s), "image", [] {
                             return LoadedImage{cv::Mat::zeros(2, 2, CV_8UC1), ""};
                           }});
  }
  void start(size_t cameras, bool with_magnetometer, const LiveSourceOptions& options = {}) {
    source_.emplace(rigOf(cameras, with_magnetometer), options, &diagnostics_);
    SynchronizerOptions synchronizer;
    synchronizer.prefetch = false;
    synchronizer_.emplace(&*source_, synchronizer, &diagnostics_);
  }
  FramePacket next() { return synchronizer_->next().value(); }

  Diagnostics diagnostics_;
  std::optional<LiveSource> source_;
  std::optional<Synchronizer> synchronizer_;
};

/// Pushes a recording's readings in the order of their stamps, like live sensors.
void play(MeasurementSource* recording, LiveSource* live) {
  std::optional<ImuSample> imu = recording->nextImu();
  std::optional<MagnetometerSample> magnetometer = recording->nextMagnetometer();
  std::vector<std::optional<PendingImage>> images = {recording->nextImage(0), recording->nextImage(1)};
  while (imu) {
    for (size_t i = 0; i < images.size(); ++i) {
      if (!images[i] || images[i]->time > imu->time) continue;
      live->push(i, *images[i]);
      images[i] = recording->nextImage(i);
    }
    if (magnetometer && magnetometer->time <= imu->time) {
      live->push(*magnetometer);
      magnetometer = recording->nextMagnetometer();
    }
    live->push(*imu);
    imu = recording->nextImu();
  }
  live->close();
}

template <typename Reading>
std::vector<Time> timesOf(const std::vector<Reading>& readings) {
  std::vector<Time> times;
  for (const Reading& reading : readings) times.push_back(reading.time);
  return times;
}

TEST_F(LiveSourceTest, MakesThePacketsOfARecording) {
  const TestRecording files;
  EurocSource recording(files.folder(), {}, &diagnostics_);
  Synchronizer expected(&recording, {}, &diagnostics_);
  EurocSource played(files.folder(), {}, &diagnostics_);
  LiveSource live(played.rig(), {}, &diagnostics_);
  std::thread sensors([&] { play(&played, &live); });
  ASSERT_TRUE(live.settleRates());
  Synchronizer synchronizer(&live, {}, &diagnostics_);
  int packets = 0;
  while (const std::optional<FramePacket> packet = expected.next()) {
    const std::optional<FramePacket> same = synchronizer.next();
    ASSERT_TRUE(same.has_value());
    EXPECT_EQ(same->time, packet->time);
    EXPECT_EQ(timesOf(same->imu), timesOf(packet->imu));
    EXPECT_EQ(timesOf(same->readings.of<MagnetometerSample>()),
              timesOf(packet->readings.of<MagnetometerSample>()));
    for (size_t i = 0; i < 2; ++i) EXPECT_EQ(cv::norm(same->images[i], packet->images[i], cv::NORM_INF), 0.0);
    ++packets;
  }
  EXPECT_EQ(packets, 21);
  EXPECT_FALSE(synchronizer.next().has_value());
  sensors.join();
  EXPECT_TRUE(diagnostics_.ranked().empty());
}

TEST_F(LiveSourceTest, DoesNotWaitForSilentSensors) {
  start(2, true);
  for (const double time_s : {0.5, 0.55, 0.6}) pushImage(0, time_s);
  pushImu(0.0, 0.8);  // later than the last image by more than the patience
  EXPECT_EQ(next().time, at(0.5));
  EXPECT_EQ(next().time, at(0.55));
  const FramePacket last = next();
  EXPECT_EQ(last.time, at(0.6));
  EXPECT_TRUE(last.readings.of<MagnetometerSample>().empty());
  EXPECT_TRUE(last.images[1].empty());
  EXPECT_EQ(diagnostics_.count("image_missing"), 3);
}

TEST_F(LiveSourceTest, DropsAndReportsWhatComesTooLate) {
  start(1, true);
  pushImage(0, 0.5);
  pushImu(0.0, 0.7);
  source_->push(MagnetometerSample{at(0.45), Vec3::UnitX()});
  EXPECT_EQ(next().readings.of<MagnetometerSample>().size(), 1U);
  source_->push(MagnetometerSample{at(0.48), Vec3::UnitX()});  // belongs to a returned packet
  source_->push(MagnetometerSample{at(0.52), Vec3::UnitX()});
  pushImage(0, 0.5);  // a duplicate
  pushImage(0, 0.55);
  const FramePacket packet = next();
  EXPECT_EQ(packet.time, at(0.55));
  EXPECT_EQ(timesOf(packet.readings.of<MagnetometerSample>()), std::vector<Time>{at(0.52)});
  EXPECT_EQ(diagnostics_.count("magnetometer_late"), 1);
  EXPECT_EQ(diagnostics_.count("image_late"), 1);
}

// The images of both cameras are pushed one after the other, in both orders of their stamps.
TEST_F(LiveSourceTest, GivesAPairWithoutWaitingForTheNextOne) {
  for (const double later_s : {-0.004, 0.0, 0.004}) {
    start(2, false);
    for (const double time_s : {0.5, 0.55}) {
      pushImage(0, time_s);
      pushImage(1, time_s + later_s);
    }
    pushImu(0.0, 0.57);
    EXPECT_EQ(next().time, at(0.5));
    std::future<FramePacket> second = std::async(std::launch::async, [this] { return next(); });
    EXPECT_EQ(second.wait_for(std::chrono::seconds(10)), std::future_status::ready);
    source_->close();  // ends the waiting of a packet that did not come
    const FramePacket packet = second.get();
    EXPECT_EQ(packet.time, at(0.55));
    EXPECT_FALSE(packet.images[1].empty());
  }
  EXPECT_TRUE(diagnostics_.ranked().empty());
}

TEST_F(LiveSourceTest, WaitsForAnImageLongerThanForOtherSensors) {
  start(1, false);
  for (const double time_s : {0.5, 0.55}) pushImage(0, time_s);
  pushImu(0.0, 0.8);
  next();
  next();
  std::future<FramePacket> third = std::async(std::launch::async, [this] { return next(); });
  EXPECT_EQ(third.wait_for(std::chrono::milliseconds(50)), std::future_status::timeout);
  pushImage(0, 0.75);
  pushImage(0, 0.8);
  pushImu(0.8, 0.9);
  EXPECT_EQ(third.get().time, at(0.75));
}

TEST_F(LiveSourceTest, PassesTheEchoesOfASonar) {
  Rig rig = rigOf(1, false);
  rig.sonar.emplace();
  source_.emplace(rig, LiveSourceOptions(), &diagnostics_);
  SynchronizerOptions options;
  options.prefetch = false;
  synchronizer_.emplace(&*source_, options, &diagnostics_);
  for (const double time_s : {0.5, 0.55}) pushImage(0, time_s);
  for (const double time_s : {0.44, 0.46, 0.52}) source_->push(SonarSample{at(time_s), 3.0, 0.1});
  pushImu(0.0, 0.7);
  EXPECT_EQ(timesOf(next().readings.of<SonarSample>()), (std::vector<Time>{at(0.44), at(0.46)}));
  source_->push(SonarSample{at(0.47), 3.0, 0.1});  // belongs to a returned packet
  EXPECT_EQ(timesOf(next().readings.of<SonarSample>()), std::vector<Time>{at(0.52)});
  EXPECT_EQ(diagnostics_.count("sonar_late"), 1);
}

TEST_F(LiveSourceTest, DropsTheOldestImagesOfAnEstimatorThatDoesNotKeepUp) {
  LiveSourceOptions options;
  options.max_images = 20;
  start(1, false, options);
  pushImage(0, 0.5);
  pushImu(0.0, 5.0);
  EXPECT_EQ(next().time, at(0.5));
  for (int i = 1; i <= 50; ++i) pushImage(0, 0.5 + 0.05 * i);
  EXPECT_EQ(source_->backlog(), 20U);
  EXPECT_EQ(next().time, at(0.5 + 0.05 * 31));
  EXPECT_EQ(diagnostics_.count("image_dropped"), 1);
}

TEST_F(LiveSourceTest, CountsImagesThatAreDroppedBeforeTheFirstOneIsTaken) {
  LiveSourceOptions options;
  options.max_images = 20;
  start(1, false, options);
  for (int i = 0; i < 50; ++i) pushImage(0, 0.5 + 0.05 * i);
  pushImu(0.0, 5.0);
  EXPECT_EQ(next().time, at(0.5 + 0.05 * 30));
  ASSERT_EQ(diagnostics_.count("image_dropped"), 1);
  EXPECT_THAT(diagnostics_.ranked().front().first_message, testing::HasSubstr("cam0: 30 from stamp"));
}

TEST_F(LiveSourceTest, SettlesUnknownRatesByTheStamps) {
  Rig rig = rigOf(1, false);
  rig.cameras[0].rate_hz = 0.0;
  source_.emplace(rig, LiveSourceOptions(), &diagnostics_);
  EXPECT_THAT(source_->unheard(), testing::ElementsAre("IMU", "cam0"));
  pushImu(0.0, 1.0);
  for (int i = 0; i < 20; ++i) pushImage(0, 0.1 * i);
  EXPECT_TRUE(source_->unheard().empty());
  ASSERT_TRUE(source_->settleRates());
  EXPECT_NEAR(source_->rig().cameras[0].rate_hz, 10.0, 1e-6);
  EXPECT_EQ(source_->rig().imu.rate_hz, 200.0);
}

TEST_F(LiveSourceTest, EndsWaitingWhenItIsClosed) {
  source_.emplace(rigOf(1, false), LiveSourceOptions(), &diagnostics_);
  std::thread sensors([this] { source_->close(); });
  EXPECT_FALSE(source_->settleRates());
  EXPECT_FALSE(source_->nextImage(0).has_value());
  sensors.join();
}

}  // namespace
}  // namespace lodeline
