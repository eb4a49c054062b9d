#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <sstream>

#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag/bag_kinds.h"
#include "lodeline/io/rosbag/bag_listing.h"
#include "lodeline/util/files/test_data.h"

// Bags of ROS 2 that other programs wrote.

namespace lodeline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class Ros2BagRealTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = testData("rosbag2");
    if (!folder_) GTEST_SKIP() << missingTestData("rosbag2");
  }

  std::string listing(const std::string& name) {
    const std::unique_ptr<BagFile> bag = openBagFile(*folder_ / name, &diagnostics_);
    std::ostringstream stream;
    listMessages(bag.get(), 100, &stream);
    return stream.str();
  }

  static size_t lines(const std::string& text) {
    return static_cast<size_t>(std::count(text.begin(), text.end(), '\n'));
  }

  std::optional<std::filesystem::path> folder_;
  Diagnostics diagnostics_;
};

TEST_F(Ros2BagRealTest, ListsAllFieldsOfAllTypes) {
  for (const char* name : {"sqlite3/cdr_test", "mcap/cdr_test", "mcap/cdr_test/cdr_test_0.mcap"}) {
    const std::string text = listing(name);
    EXPECT_EQ(lines(text), 7u) << name;
    EXPECT_EQ(text.find("not decoded"), std::string::npos) << name;
    EXPECT_EQ(text.find("does not describe"), std::string::npos) << name;
    EXPECT_THAT(
        text,
        AllOf(
            HasSubstr("1586406456763032325 /test_topic test_msgs/BasicTypes {bool_value: false, byte_value: "
                      "0, char_value: 0, float32_value: 0, float64_value: 0, int8_value: 0, uint8_value: 0, "
                      "int16_value: 0, uint16_value: 0, int32_value: 123, uint32_value: 0, int64_value: 0, "
                      "uint64_value: 0}\n"),
            HasSubstr("string_values: [\"Complex Hello1\", \"Complex Hello2\", \"Complex Hello3\"]"),
            HasSubstr("uint64_values_default: [0, 1, 18446744073709551615], string_values_default: [\"\", "
                      "\"max value\", \"min value\"], alignment_check: 0}"),
            HasSubstr("float64_values_default: [3.1415, 0, -3.1415]")))
        << name;
  }
}

TEST_F(Ros2BagRealTest, BothContainersHoldTheSameMessages) {
  for (const auto& [database, mcap] :
       {std::pair("sqlite3/cdr_test", "mcap/cdr_test"), std::pair("sqlite3/wbag", "mcap/wbag")}) {
    const std::string one = listing(database);
    EXPECT_GT(lines(one), 6u);
    EXPECT_EQ(lines(one), lines(listing(mcap)));
  }
}

TEST_F(Ros2BagRealTest, ListsServiceEvents) {
  for (const char* name : {"bags/topics_and_services.db3", "bags/topics_and_services.mcap"}) {
    const std::string text = listing(name);
    EXPECT_GT(lines(text), 4u) << name;
    EXPECT_EQ(text.find("not decoded"), std::string::npos) << text;
    EXPECT_EQ(text.find("does not describe"), std::string::npos) << text;
    EXPECT_THAT(text, AllOf(HasSubstr("example_interfaces/srv/AddTwoInts_Event {info: {event_type: "),
                            HasSubstr("request: [{a: ")))
        << name;
  }
}

TEST_F(Ros2BagRealTest, SplitFilesAreReadInTheOrderOfTime) {
  for (const char* name : {"sqlite3/wbag", "mcap/wbag"}) {
    const std::unique_ptr<BagFile> bag = openBagFile(*folder_ / name, &diagnostics_);
    EXPECT_EQ(bag->topics().size(), 8u) << name;
    size_t messages = 0;
    for (const BagTopic& topic : bag->topics()) {
      messages += topic.entries.size();
      for (size_t i = 1; i < topic.entries.size(); ++i) {
        ASSERT_LE(topic.entries[i - 1].received, topic.entries[i].received);
      }
    }
    EXPECT_EQ(messages, 6074u) << name;
  }
  EXPECT_TRUE(diagnostics_.ranked().empty());
}

TEST_F(Ros2BagRealTest, SaysWhyMessagesAreNotDecoded) {
  EXPECT_THAT(listing("sqlite3/wrong_rmw_test"),
              HasSubstr("not decoded: the serialization format 'wrong_format' of its messages is not read"));
  EXPECT_THAT(listing("sqlite3/wrong_rmw_test/wrong_rmw_test_0.db3"),
              HasSubstr("not decoded: the bag has no definition of test_msgs/Arrays"));
}

TEST_F(Ros2BagRealTest, MetadataIsNotNeeded) {
  EXPECT_EQ(listing("sqlite3/talker"), listing("sqlite3/talker/talker.db3"));
}

}  // namespace
}  // namespace lodeline
