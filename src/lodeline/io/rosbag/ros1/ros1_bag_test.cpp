#include "lodeline/io/rosbag/ros1/ros1_bag.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fmt/format.h>

#include "lodeline/diagnostics.h"
#include "lodeline/io/euroc/test_recording.h"
#include "lodeline/io/rosbag/messages.h"
#include "lodeline/io/rosbag/test_bag.h"

namespace lodeline {
namespace {

using ::testing::HasSubstr;

/// Messages of TestRecording: IMU 200 Hz from 0.5 to 2.5 s, magnetometer 50 Hz, two cameras 20 Hz for 1 s.
constexpr size_t kImuMessages = 401;
constexpr size_t kImages = 21;

class BagFileTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!test::hasRosbag()) GTEST_SKIP() << test::kRosbagMissing;
    test::addPgmImages(recording_.folder() / "mav0");
  }

  std::filesystem::path write(const std::string& compression, const std::string& images = "raw") {
    const std::filesystem::path bag = recording_.folder() / (compression + images + ".bag");
    test::runRosbag(fmt::format("write '{}' '{}' {} {}", (recording_.folder() / "mav0").string(),
                                bag.string(), compression, images));
    return bag;
  }

  static size_t count(const BagFile& bag, const std::string& topic) {
    for (const BagTopic& candidate : bag.topics()) {
      if (candidate.connection.topic == topic) return candidate.entries.size();
    }
    return 0;
  }

  static size_t readable(BagFile* bag) {
    size_t messages = 0;
    for (const BagTopic& topic : bag->topics()) {
      for (const BagEntry& entry : topic.entries) messages += bag->stored(entry) ? 1 : 0;
    }
    return messages;
  }

  TestRecording recording_;
  Diagnostics diagnostics_;
};

TEST_F(BagFileTest, ReadsWhatRosbagWrote) {
  for (const char* compression : {"none", "bz2", "lz4"}) {
    Ros1Bag bag(write(compression), &diagnostics_);
    ASSERT_EQ(bag.topics().size(), 4u) << compression;
    EXPECT_EQ(count(bag, "/imu/data"), kImuMessages);
    EXPECT_EQ(count(bag, "/left/image_raw"), kImages);
    const BagTopic& imu = bag.topics()[0];
    EXPECT_EQ(imu.connection.type, "sensor_msgs/Imu");
    for (size_t i = 0; i < imu.entries.size(); ++i) {
      const std::optional<wire::Bytes> message = bag.stored(imu.entries[i]);
      ASSERT_TRUE(message);
      const ImuSample sample = messages::parseImu(*message);
      const double t = 0.5 + 0.005 * static_cast<double>(i);
      EXPECT_EQ(sample.time, testTime(t));
      EXPECT_NEAR(sample.angular_velocity_B.x(), t, 1e-9);
    }
  }
  EXPECT_TRUE(diagnostics_.ranked().empty());
}

TEST_F(BagFileTest, RecoversABagThatWasNotClosed) {
  for (const char* compression : {"none", "bz2", "lz4"}) {
    const std::filesystem::path file = recording_.folder() / "unclosed.bag";
    test::runRosbag(fmt::format("unclosed '{}' '{}' {}", (recording_.folder() / "mav0").string(),
                                file.string(), compression));
    Diagnostics diagnostics;
    Ros1Bag bag(file, &diagnostics);
    EXPECT_GT(count(bag, "/imu/data"), kImuMessages - 250) << compression;
    EXPECT_EQ(diagnostics.count("bag_unindexed") + diagnostics.count("bag_truncated"), 1) << compression;
    EXPECT_GT(readable(&bag), 0u);
  }
}

TEST_F(BagFileTest, RecoversATruncatedBagAtAnyLength) {
  for (const char* compression : {"none", "bz2", "lz4"}) {
    const std::filesystem::path file = write(compression);
    Ros1Bag whole(file, &diagnostics_);
    const size_t all = readable(&whole);
    const std::string content = test::contentOf(file);
    size_t before = 0;
    for (size_t length = content.size() / 20; length < content.size(); length += content.size() / 20) {
      test::writeContent(file, content.substr(0, length));
      Diagnostics diagnostics;
      size_t messages = 0;
      try {
        Ros1Bag bag(file, &diagnostics);
        messages = readable(&bag);
        EXPECT_EQ(diagnostics.count("bag_truncated"), 1) << compression << " " << length;
      } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("no message")) << compression << " " << length;
      }
      EXPECT_GE(messages, before) << compression << " " << length;
      EXPECT_LE(messages, all);
      before = messages;
    }
    // In the last case, only the summary at the end is missing.
    EXPECT_GT(before, all * 8 / 10) << compression;
  }
}

TEST_F(BagFileTest, GoesOnPastDamagedBytes) {
  for (const char* compression : {"none", "bz2", "lz4"}) {
    const std::filesystem::path file = write(compression);
    Ros1Bag whole(file, &diagnostics_);
    const size_t all = readable(&whole);
    std::string content = test::contentOf(file);
    const size_t middle = content.size() / 3;
    for (size_t i = middle; i < middle + 3000; ++i) content[i] = static_cast<char>(i * 31);
    test::writeContent(file, content);
    Diagnostics diagnostics;
    Ros1Bag bag(file, &diagnostics);
    const size_t messages = readable(&bag);
    EXPECT_GT(messages, all / 4) << compression;
    EXPECT_GT(bag.topics()[0].entries.back().received, testTime(2.4)) << compression;
    // Without compression, the damage may affect only pixels.
    EXPECT_LE(messages, compression == std::string("none") ? all : all - 1) << compression;
    EXPECT_FALSE(diagnostics.ranked().empty()) << compression;
  }
}

TEST_F(BagFileTest, RefusesWhatIsNoReadableBag) {
  const std::filesystem::path file = recording_.folder() / "odd.bag";
  const auto refusal = [&](const std::string& content) {
    test::writeContent(file, content);
    try {
      Ros1Bag bag(file, &diagnostics_);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_THAT(refusal(""), HasSubstr("empty"));
  EXPECT_THAT(refusal("a photograph"), HasSubstr("no ROS 1 bag"));
  EXPECT_THAT(refusal("#ROSBAG V1.2\n..."), HasSubstr("rosbag fix"));
  EXPECT_THAT(refusal("#ROSBAG V2.0\n"), HasSubstr("no message"));
  EXPECT_THAT(refusal("#ROSBAG V2.0\n" + std::string(5000, '\0')), HasSubstr("no message"));
  EXPECT_THROW(Ros1Bag(recording_.folder() / "none.bag", &diagnostics_), InputError);
}

}  // namespace
}  // namespace lodeline
