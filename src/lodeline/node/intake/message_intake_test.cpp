#include "lodeline/node/intake/message_intake.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

#include "lodeline/io/rosbag/convert/ros2_messages.h"
#include "lodeline/io/rosbag/image_messages.h"
#include "lodeline/io/rosbag/robots/current_messages.h"
#include "lodeline/io/rosbag/robots/dvl_messages.h"

namespace lodeline {
namespace {

using definitions::Serialization;

Time at(double seconds) { return Time::fromSeconds(1000.0 + seconds); }

Rig rigOf() {
  Rig rig;
  rig.cameras.resize(2);
  rig.cameras[0].name = "cam0";
  rig.cameras[1].name = "cam1";
  rig.magnetometer.emplace();
  rig.pressure.emplace();
  rig.sonar.emplace();
  return rig;
}

/// Messages of ROS 2 for a rig with every kind of sensor. The topics are in the order of the sensors' names.
class MessageIntakeTest : public testing::Test {
 protected:
  enum Topic : size_t { kCam0, kCam1, kImu, kMag, kPressure, kSonar };

  MessageIntakeTest() : source_(rigOf(), {}, &diagnostics_) {
    intake_.emplace(subscriptionsOf({{"cam0", "/left"},
                                     {"cam1", "/right"},
                                     {"imu0", "/imu"},
                                     {"mag0", "/field"},
                                     {"pressure0", "/pressure"},
                                     {"sonar0", "/range"}}),
                    WaterColumn(), Serialization::Cdr, &source_);
  }
  void receive(Topic topic, const messages::Type& type, const wire::Bytes& ros1) {
    intake_->receive(topic, type.name, "", ros2_.toCdr(type.name, ros1));
  }
  SensorTraffic trafficOf(Topic topic) const { return intake_->traffic()[topic]; }

  Diagnostics diagnostics_;
  LiveSource source_;
  Ros2Messages ros2_;
  std::optional<MessageIntake> intake_;
};

TEST_F(MessageIntakeTest, PushesTheReadingsOfEverySensor) {
  receive(kImu, messages::kImu, messages::imu({at(0.0), Vec3(0.1, 0.2, 0.3), Vec3(1.0, 2.0, 9.0)}, 0));
  receive(kMag, messages::kMagneticField, messages::magneticField({at(0.1), Vec3(1e-5, 2e-5, 3e-5)}, 0));
  receive(kPressure, messages::kFluidPressure, messages::fluidPressure({at(0.2), 7.5}, {}, 0));
  receive(kSonar, messages::kLaserScan, messages::laserScan({at(0.3), 4.0, 0.5}, 0));
  cv::Mat pixels(3, 5, CV_8UC1);
  for (int i = 0; i < 15; ++i) pixels.data[i] = static_cast<uint8_t>(10 * i);
  receive(kCam1, messages::kImage, messages::image(at(0.4), "cam1", pixels, 0));
  source_.close();
  const ImuSample imu = source_.nextImu().value();
  EXPECT_EQ(imu.time, at(0.0));
  EXPECT_EQ(imu.angular_velocity_B, Vec3(0.1, 0.2, 0.3));
  EXPECT_EQ(imu.specific_force_B, Vec3(1.0, 2.0, 9.0));
  EXPECT_EQ(source_.nextMagnetometer().value().field_M, Vec3(1e-5, 2e-5, 3e-5));
  EXPECT_NEAR(source_.nextDepth().value().depth_m, 7.5, 1e-9);
  EXPECT_EQ(source_.nextSonar().value().range_m, 4.0);
  EXPECT_FALSE(source_.nextImage(0).has_value());
  const PendingImage image = source_.nextImage(1).value();
  EXPECT_EQ(image.time, at(0.4));
  EXPECT_EQ(cv::norm(image.load().image, pixels, cv::NORM_INF), 0.0);
  for (const SensorTraffic& traffic : intake_->traffic()) EXPECT_EQ(traffic.unusable, 0U) << traffic.topic;
}

TEST_F(MessageIntakeTest, CountsWhatIsOfNoUse) {
  const ImuSample sample = {at(0.0), Vec3(0.1, 0.2, 0.3), Vec3(0.0, 0.0, 9.8)};
  wire::Bytes cut = ros2_.toCdr(messages::kImu.name, messages::imu(sample, 0));
  cut.resize(cut.size() / 2);
  intake_->receive(kImu, messages::kImu.name, "", cut);
  EXPECT_EQ(trafficOf(kImu).unusable, 1U);
  EXPECT_NE(trafficOf(kImu).problem.find("shorter"), std::string::npos);
  intake_->receive(kImu, messages::kImu.name, "", {});
  intake_->receive(kImu, messages::kImu.name, "", {0x7F, 0x7F, 0, 0, 1, 2, 3});
  ImuSample not_finite = sample;
  not_finite.specific_force_B.x() = std::numeric_limits<double>::quiet_NaN();
  receive(kImu, messages::kImu, messages::imu(not_finite, 0));
  intake_->receive(kImu, "sensor_msgs/Temperature", "", {});
  EXPECT_EQ(trafficOf(kImu).received, 5U);
  EXPECT_EQ(trafficOf(kImu).unusable, 5U);
  EXPECT_NE(trafficOf(kImu).problem.find("sensor_msgs/Temperature"), std::string::npos);
  intake_->addLost(kImu, 3);
  EXPECT_EQ(trafficOf(kImu).lost, 3U);
  source_.close();
  EXPECT_FALSE(source_.nextImu().has_value());
}

TEST_F(MessageIntakeTest, RefusesAnotherDefinitionOfAType) {
  intake_->receive(kImu, messages::kImu.name, "0123456789abcdef0123456789abcdef", {});
  EXPECT_EQ(trafficOf(kImu).unusable, 1U);
}

/// An accelerometer at 100 Hz whose reading grows with time, and a gyroscope at 200 Hz.
TEST(LiveImuHalves, MergeAsTheReadingsArrive) {
  LiveImuHalves halves;
  const auto force = [](double time_s) {
    return ImuSample{at(time_s), Vec3::Zero(), Vec3(time_s, 0.0, 9.8)};
  };
  const auto turn = [](double time_s) { return ImuSample{at(time_s), Vec3(0.1, 0.0, time_s), Vec3::Zero()}; };
  halves.add(force(0.0));
  halves.add(turn(0.005));
  EXPECT_FALSE(halves.next()) << "the next reading of the accelerometer is not there";
  halves.add(turn(0.010));
  halves.add(force(0.010));
  const ImuSample first = halves.next().value();
  EXPECT_EQ(first.time, at(0.005));
  EXPECT_NEAR(first.specific_force_B.x(), 0.005, 1e-12);
  EXPECT_EQ(halves.next().value().time, at(0.010));
  EXPECT_FALSE(halves.next());
  halves.add(force(0.020));
  halves.add(turn(0.015));
  EXPECT_NEAR(halves.next().value().specific_force_B.x(), 0.015, 1e-12);
  EXPECT_EQ(halves.dropped(), 0U);
}

TEST(LiveImuHalves, DoNotGrowWhileOneHalfIsSilent) {
  LiveImuHalves halves;
  for (size_t i = 0; i < LiveImuHalves::kMostWaiting + 10; ++i) {
    halves.add({at(0.005 * static_cast<double>(i)), Vec3::UnitX(), Vec3::Zero()});
    EXPECT_FALSE(halves.next());
  }
  EXPECT_EQ(halves.dropped(), 10U);
}

/// The sensors of a robot, whose topics are altimeter, currents and DVL in this order.
class RobotIntakeTest : public testing::Test {
 protected:
  enum Topic : size_t { kAltimeter, kCurrents, kDvl };

  static Rig rigOf(const std::vector<std::string>& channels) {
    Rig rig;
    rig.cameras.resize(1);
    rig.cameras[0].name = "cam0";
    rig.altimeter.emplace();
    rig.dvl.emplace();
    rig.currents.emplace().channels = channels;
    return rig;
  }
  void open(const std::vector<std::string>& channels) {
    source_.emplace(rigOf(channels), LiveSourceOptions(), &diagnostics_);
    intake_.emplace(
        subscriptionsOf({{"altimeter0", "/altimeter"}, {"current0", "/currents"}, {"dvl0", "/dvl"}}),
        WaterColumn(), Serialization::Cdr, &*source_);
  }
  void receive(Topic topic, const messages::Type& type, const wire::Bytes& ros1) {
    intake_->receive(topic, type.name, "", ros2_.toCdr(type.name, ros1));
  }

  Diagnostics diagnostics_;
  Ros2Messages ros2_;
  std::optional<LiveSource> source_;
  std::optional<MessageIntake> intake_;
};

TEST_F(RobotIntakeTest, PushesTheReadings) {
  open({"lamp", "thruster"});
  receive(kAltimeter, messages::kRange, messages::altimeterRange({at(0.0), 2.5}, 0));
  receive(kCurrents, messages::kJointState,
          messages::jointCurrents({at(0.1), {7.0, 0.5}}, {"thruster", "lamp"}, 0));
  DvlSample ping;
  ping.time = at(0.2);
  ping.velocity_D = Vec3(0.5, 0.25, -0.125);
  ping.beams = {{0, 0.5, 2.0}, {1, std::nullopt, std::nullopt}, {2, 0.25, 2.5}, {3, 0.125, 2.5}};
  receive(kDvl, messages::kMarineDvl, messages::marineDvl(ping, DvlCalibration().beams_D, 0));
  source_->close();
  EXPECT_EQ(source_->nextAltimeter().value().range_m, 2.5);
  EXPECT_EQ(source_->nextCurrents().value().currents_A, (std::vector<double>{0.5, 7.0}));
  const DvlSample taken = source_->nextDvl().value();
  EXPECT_EQ(taken.velocity_D, ping.velocity_D);
  ASSERT_EQ(taken.beams.size(), 4U);
  EXPECT_FALSE(taken.beams[1].velocity_m_per_s);
  EXPECT_EQ(taken.beams[2].range_m, 2.5);
  for (const SensorTraffic& traffic : intake_->traffic()) EXPECT_EQ(traffic.unusable, 0U) << traffic.problem;
}

TEST_F(RobotIntakeTest, NeverExchangesChannels) {
  const wire::Bytes message = messages::jointCurrents({at(0.1), {7.0, 0.5}}, {"thruster", "lamp"}, 0);
  open({"lamp", "other"});
  receive(kCurrents, messages::kJointState, message);
  EXPECT_EQ(intake_->traffic()[kCurrents].unusable, 1U);
  EXPECT_NE(intake_->traffic()[kCurrents].problem.find("missing: other"), std::string::npos);
  open({});
  receive(kCurrents, messages::kJointState, message);
  EXPECT_NE(intake_->traffic()[kCurrents].problem.find("channels"), std::string::npos);
}

TEST_F(RobotIntakeTest, CountsMessagesOfAnotherVersion) {
  open({"lamp"});
  DvlSample ping;
  ping.time = at(0.2);
  wire::Bytes longer =
      ros2_.toCdr(messages::kMarineDvl.name, messages::marineDvl(ping, DvlCalibration().beams_D, 0));
  longer.resize(longer.size() + 24);
  intake_->receive(kDvl, messages::kMarineDvl.name, "", longer);
  EXPECT_EQ(intake_->traffic()[kDvl].unusable, 1U);
}

}  // namespace
}  // namespace lodeline
