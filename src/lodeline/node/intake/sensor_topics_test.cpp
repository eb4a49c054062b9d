#include "lodeline/node/intake/sensor_topics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

RigFile twoCameras() {
  RigFile file;
  file.has_imu = true;
  for (const char* name : {"cam0", "cam1"}) {
    CameraCalibration camera;
    camera.name = name;
    file.rig.cameras.push_back(camera);
  }
  file.rig.magnetometer.emplace();
  file.rig.pressure.emplace();
  file.topics = {{"cam0", "/left"}, {"cam1", "/right"}, {"imu0", "/imu"}, {"mag0", "/field"}};
  return file;
}

TEST(LiveTopics, ParametersGoOverTheRigFile) {
  const RigFile file = twoCameras();
  Rig rig = file.rig;
  const auto topics = chooseLiveTopics(file, {{"cam1", "/other"}, {"pressure0", "/depth"}}, &rig);
  const std::map<std::string, std::string> expected = {
      {"cam0", "/left"}, {"cam1", "/other"}, {"imu0", "/imu"}, {"mag0", "/field"}, {"pressure0", "/depth"}};
  EXPECT_EQ(topics, expected);
  EXPECT_TRUE(rig.pressure.has_value());
}

TEST(LiveTopics, SensorsWithoutATopicAreLeftOut) {
  RigFile file = twoCameras();
  file.topics.erase("mag0");
  Rig rig = file.rig;
  const auto topics = chooseLiveTopics(file, {}, &rig);
  EXPECT_FALSE(topics.contains("mag0"));
  EXPECT_FALSE(rig.magnetometer.has_value());
  EXPECT_FALSE(rig.pressure.has_value());
}

TEST(LiveTopics, SaysWhichTopicIsMissingOrTooMany) {
  RigFile file = twoCameras();
  Rig rig = file.rig;
  EXPECT_THAT(
      [&] {
        chooseLiveTopics(file, {{"cam2", "/third"}}, &rig);
      },
      ThrowsMessage<UsageError>(HasSubstr("topic /third of cam2")));
  file.topics.erase("cam1");
  EXPECT_THAT([&] { chooseLiveTopics(file, {}, &rig); },
              ThrowsMessage<InputError>(HasSubstr("no topic is known for cam1")));
}

TEST(LiveTopics, AnImuMayHaveTwoTopics) {
  const std::vector<SensorTopic> topics = subscriptionsOf({{"cam0", "/left"}, {"imu0", "/gyro,/accel"}});
  ASSERT_EQ(topics.size(), 3U);
  EXPECT_TRUE(topics[0].isCamera());
  EXPECT_FALSE(topics[0].is_half);
  EXPECT_EQ(topics[1].topic, "/gyro");
  EXPECT_EQ(topics[2].topic, "/accel");
  EXPECT_TRUE(topics[1].is_half && topics[2].is_half);
  EXPECT_THROW(subscriptionsOf({{"cam0", "/a,/b"}}), UsageError);
  EXPECT_THROW(subscriptionsOf({{"cam0", "/a"}, {"cam1", "/a"}}), UsageError);
}

}  // namespace
}  // namespace lodeline
