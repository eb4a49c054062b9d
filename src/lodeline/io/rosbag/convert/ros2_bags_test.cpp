#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <zstd.h>

#include <array>
#include <memory>
#include <opencv2/core.hpp>
#include <string>

#include "lodeline/diagnostics.h"
#include "lodeline/io/euroc/test_recording.h"
#include "lodeline/io/rosbag/bag_kinds.h"
#include "lodeline/io/rosbag/bag_source.h"
#include "lodeline/io/rosbag/convert/bag_writer.h"
#include "lodeline/io/rosbag/image_messages.h"
#include "lodeline/io/rosbag/messages.h"
#include "lodeline/io/rosbag/ros2/mcap_record.h"
#include "lodeline/io/rosbag/test_bag.h"

// Bags of ROS 2 that Lodeline writes, whole and damaged in many ways.

namespace lodeline {
namespace {

using ::testing::HasSubstr;

constexpr int kWrittenImages = 60;
constexpr int kWrittenReadings = 600;

Time at(int64_t reading) { return Time::fromNanoseconds(1'000'000'000'000 + reading * 5'000'000); }

class Ros2BagsTest : public testing::Test {
 protected:
  std::filesystem::path path(const std::string& name) const { return place_.folder() / name; }

  /// Writes readings `first` to `end` of an IMU, and an image for every tenth.
  std::filesystem::path write(const std::string& name, const std::string& compression, int first = 0,
                              int end = kWrittenReadings) {
    const BagFormat format = name.find("db3") != std::string::npos ? BagFormat::Database : BagFormat::Mcap;
    const std::unique_ptr<BagWriter> writer = makeBagWriter(path(name), format, compression);
    cv::Mat pixels(400, 500, CV_8UC1);
    cv::RNG random(1);
    for (int i = first; i < end; ++i) {
      const double number = i;
      const ImuSample sample{at(i), {number, 0.25, -1e-9}, {1.0, 2.0, 9.81}};
      writer->write("/imu", messages::kImu.name, at(i), messages::imu(sample, 0));
      if (i % 10 != 0) continue;
      random.fill(pixels, cv::RNG::NORMAL, 90.0, 8.0);
      writer->write("/image", messages::kImage.name, at(i), messages::image(at(i), "cam0", pixels, 0));
    }
    writer->close();
    return path(name);
  }

  /// Number of readable messages; the readings must be those that were written.
  size_t readable(const std::filesystem::path& file, Diagnostics* diagnostics) {
    const std::unique_ptr<BagFile> bag = openBagFile(file, diagnostics);
    size_t messages = 0;
    for (const BagTopic& topic : bag->topics()) {
      for (const BagEntry& entry : topic.entries) {
        const std::optional<wire::Bytes> message = bag->read(topic, entry);
        if (!message) continue;
        ++messages;
        if (topic.connection.topic != "/imu") continue;
        const ImuSample sample = messages::parseImu(*message);
        EXPECT_EQ(sample.time, entry.received);
        EXPECT_EQ(at(static_cast<int64_t>(sample.angular_velocity_B.x())), sample.time);
        EXPECT_EQ(sample.specific_force_B, Vec3(1.0, 2.0, 9.81));
      }
    }
    return messages;
  }

  TestRecording place_;
  Diagnostics diagnostics_;
};

TEST_F(Ros2BagsTest, ReadsWhatItWrites) {
  for (const char* name : {"a.mcap none", "b.mcap lz4", "c.mcap zstd", "d.db3 none", "mcap_folder zstd"}) {
    const std::string text(name);
    const size_t space = text.find(' ');
    const auto file = write(text.substr(0, space), text.substr(space + 1));
    EXPECT_EQ(readable(file, &diagnostics_), size_t{kWrittenReadings + kWrittenImages}) << name;
  }
  EXPECT_TRUE(diagnostics_.ranked().empty());
}

TEST_F(Ros2BagsTest, RecoversATruncatedMcapAtAnyLength) {
  for (const char* compression : {"none", "lz4", "zstd"}) {
    const auto file = write("cut.mcap", compression);
    const std::string content = test::contentOf(file);
    size_t before = 0;
    for (size_t length = content.size() / 25; length < content.size(); length += content.size() / 25) {
      test::writeContent(file, content.substr(0, length));
      Diagnostics diagnostics;
      size_t messages = 0;
      try {
        messages = readable(file, &diagnostics);
        const int reports = diagnostics.count("bag_truncated") + diagnostics.count("bag_unindexed");
        // A file that lacks only the magic bytes at its end is whole.
        EXPECT_EQ(reports, length + mcap::kMagic.size() < content.size() ? 1 : 0) << length;
      } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("no message")) << length;
      }
      EXPECT_GE(messages, before) << compression << " " << length;
      before = messages;
    }
    EXPECT_GT(before, size_t{kWrittenReadings + kWrittenImages} * 8 / 10) << compression;
  }
}

TEST_F(Ros2BagsTest, GoesOnPastDamagedBytes) {
  for (const char* compression : {"none", "lz4", "zstd"}) {
    const auto file = write("damaged.mcap", compression);
    std::string content = test::contentOf(file);
    // The first chunk's head, so that the records after it can be found in the summary alone.
    const size_t chunk = content.find("\x06", 8 + 9);
    for (size_t i = chunk + 1; i < chunk + 9; ++i) content[i] = '\x7F';
    test::writeContent(file, content);
    Diagnostics diagnostics;
    const size_t messages = readable(file, &diagnostics);
    EXPECT_GT(messages, size_t{kWrittenReadings + kWrittenImages} / 2) << compression;
    EXPECT_LT(messages, size_t{kWrittenReadings + kWrittenImages}) << compression;
    EXPECT_EQ(diagnostics.count("bag_damaged"), 1) << compression;
  }
}

TEST_F(Ros2BagsTest, AWrongChecksumLosesItsChunkAlone) {
  const auto file = write("checksum.mcap", "lz4");
  std::string content = test::contentOf(file);
  const size_t chunk = content.find('\x06', 8 + 9 + 4 + 4 + 4 + 8);
  content[chunk + 9 + 24] = static_cast<char>(content[chunk + 9 + 24] ^ 1);  // the checksum
  test::writeContent(file, content);
  const size_t messages = readable(file, &diagnostics_);
  EXPECT_LT(messages, size_t{kWrittenReadings + kWrittenImages});
  EXPECT_GT(messages, size_t{kWrittenReadings + kWrittenImages} / 3);
  EXPECT_GT(diagnostics_.count("bag_chunk"), 0);
}

TEST_F(Ros2BagsTest, ReadsMessagesOutsideOfChunks) {
  const std::string content = test::contentOf(write("chunked.mcap", "none"));
  const std::span<const uint8_t> bytes(reinterpret_cast<const uint8_t*>(content.data()), content.size());
  std::string loose(mcap::kMagic);
  for (size_t position = loose.size(); position < content.size();) {
    const std::optional<mcap::RecordHead> head = mcap::recordHead(bytes.subspan(position));
    ASSERT_TRUE(head);
    const auto record = bytes.subspan(position + mcap::kRecordHead, head->size);
    if (head->kind == mcap::Kind::Chunk) {
      loose += content.substr(position + mcap::kRecordHead + mcap::parseChunk(record).size,
                              mcap::parseChunk(record).packed_size);
    }
    if (head->kind == mcap::Kind::DataEnd) break;
    position += mcap::kRecordHead + head->size;
  }
  test::writeContent(path("loose.mcap"), loose);
  EXPECT_EQ(readable(path("loose.mcap"), &diagnostics_), size_t{kWrittenReadings + kWrittenImages});
  EXPECT_EQ(diagnostics_.count("bag_unindexed"), 1);
}

TEST_F(Ros2BagsTest, ReadsFilesThatArePackedAsAWhole) {
  for (const char* name : {"packed.mcap", "packed.db3"}) {
    const auto file = write(name, "none");
    const std::string content = test::contentOf(file);
    std::string packed(ZSTD_compressBound(content.size()), '\0');
    packed.resize(ZSTD_compress(packed.data(), packed.size(), content.data(), content.size(), 1));
    std::filesystem::remove(file);
    test::writeContent(file.string() + ".zstd", packed);
    EXPECT_EQ(readable(file.string() + ".zstd", &diagnostics_), size_t{kWrittenReadings + kWrittenImages})
        << name;
    EXPECT_TRUE(diagnostics_.ranked().empty());
    std::filesystem::remove(file.string() + ".zstd");
  }
}

TEST_F(Ros2BagsTest, ReadsMessagesThatArePackedOneByOne) {
  const auto file = write("messages.db3", "");
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  const auto pack = [](sqlite3_context* context, int, sqlite3_value** values) {
    const auto size = static_cast<size_t>(sqlite3_value_bytes(values[0]));
    std::string packed(ZSTD_compressBound(size), '\0');
    packed.resize(ZSTD_compress(packed.data(), packed.size(), sqlite3_value_blob(values[0]), size, 1));
    sqlite3_result_blob(context, packed.data(), static_cast<int>(packed.size()), SQLITE_TRANSIENT);
  };
  sqlite3_create_function(database, "pack", 1, SQLITE_UTF8, nullptr, pack, nullptr, nullptr);
  EXPECT_EQ(sqlite3_exec(database, "UPDATE messages SET data = pack(data)", nullptr, nullptr, nullptr),
            SQLITE_OK);
  sqlite3_close(database);
  EXPECT_EQ(readable(file, &diagnostics_), size_t{kWrittenReadings + kWrittenImages});
  EXPECT_TRUE(diagnostics_.ranked().empty());
}

TEST_F(Ros2BagsTest, OldSchemasWithoutDefinitionsUseTheBuiltInOnes) {
  const auto file = write("old.db3", "");
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open(file.c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database,
                         "DROP TABLE message_definitions; DROP TABLE schema; DROP TABLE metadata;"
                         "ALTER TABLE topics DROP COLUMN offered_qos_profiles;"
                         "ALTER TABLE topics DROP COLUMN type_description_hash",
                         nullptr, nullptr, nullptr),
            SQLITE_OK);
  sqlite3_close(database);
  EXPECT_EQ(readable(file, &diagnostics_), size_t{kWrittenReadings + kWrittenImages});
}

TEST_F(Ros2BagsTest, SplitFilesNeedNoMetadata) {
  std::filesystem::create_directories(path("split"));
  write("split/bag_10.mcap", "zstd", 400, kWrittenReadings);
  write("split/bag_2.mcap", "lz4", 200, 400);
  write("split/bag_1.mcap", "none", 0, 200);
  EXPECT_EQ(readable(path("split"), &diagnostics_), size_t{kWrittenReadings + kWrittenImages});
  const std::unique_ptr<BagFile> bag = openBagFile(path("split"), &diagnostics_);
  const std::vector<BagEntry>& entries = bag->topics()[1].entries;
  for (size_t i = 0; i < entries.size(); ++i) ASSERT_EQ(entries[i].received, at(static_cast<int64_t>(i)));
  EXPECT_TRUE(diagnostics_.ranked().empty());
  test::writeContent(path("split/metadata.yaml"),
                     "rosbag2_bagfile_information:\n  message_count: 660\n  relative_file_paths:\n"
                     "    - bag_1.mcap\n    - bag_2.mcap\n    - bag_3.mcap\n");
  EXPECT_EQ(readable(path("split"), &diagnostics_), size_t{440});
  EXPECT_EQ(diagnostics_.count("bag_part_missing"), 1);
  EXPECT_EQ(diagnostics_.count("bag_part_unused"), 1);
  EXPECT_EQ(diagnostics_.count("bag_truncated"), 1);
}

TEST_F(Ros2BagsTest, ADamagedDatabaseGivesWhatCanBeRead) {
  const auto file = write("damaged.db3", "");
  const std::string content = test::contentOf(file);
  test::writeContent(file, content.substr(0, content.size() / 2));
  try {
    EXPECT_LT(readable(file, &diagnostics_), size_t{kWrittenReadings + kWrittenImages});
    EXPECT_GT(diagnostics_.count("bag_damaged"), 0);
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("damaged.db3"));
  }
}

TEST_F(Ros2BagsTest, UnitesTheHalvesOfAnImu) {
  const std::unique_ptr<BagWriter> writer = makeBagWriter(path("halves.mcap"), BagFormat::Mcap, "");
  for (int i = 0; i < 100; ++i) {
    writer->write("/camera/gyro/sample", messages::kImu.name, at(i),
                  messages::imu({at(i), {0.5, 0, 0}, Vec3::Zero()}, 0));
    if (i % 2 != 0) continue;
    writer->write("/camera/accel/sample", messages::kImu.name, at(i),
                  messages::imu({at(i), Vec3::Zero(), {0, 0, 9.8}}, 0));
  }
  writer->close();
  BagOptions options;
  options.needs_calibration = false;
  BagSource source(path("halves.mcap"), options, &diagnostics_);
  int readings = 0;
  while (const std::optional<ImuSample> sample = source.nextImu()) {
    EXPECT_EQ(sample->angular_velocity_B, Vec3(0.5, 0, 0));
    EXPECT_NEAR(sample->specific_force_B.z(), 9.8, 1e-12);
    ++readings;
  }
  EXPECT_EQ(readings, 99);
  EXPECT_EQ(diagnostics_.count("imu_united"), 1);
}

TEST_F(Ros2BagsTest, ANamedOdometryGivesDepths) {
  const std::unique_ptr<BagWriter> writer = makeBagWriter(path("odometry.mcap"), BagFormat::Mcap, "");
  for (int i = 0; i < 3; ++i) {
    wire::Writer message;
    message.put(uint32_t{0});
    message.putTime(at(i));
    message.putText("map");
    message.putText("base_link");
    std::array<double, 3 + 4 + 36 + 6 + 36> numbers{1.0, 2.0, -7.25};
    wire::Bytes bytes = message.take();
    const auto* first = reinterpret_cast<const uint8_t*>(numbers.data());
    bytes.insert(bytes.end(), first, first + sizeof(numbers));
    writer->write("/depth", messages::kOdometry.name, at(i), std::move(bytes));
  }
  writer->close();
  BagOptions options;
  options.needs_calibration = false;
  options.topics = {{"pressure0", "/depth"}};
  test::writeContent(path("rig.yaml"),
                     "pressure0: {T_BS: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1], depth_noise_std: 0.01}\n");
  options.rig_files = {path("rig.yaml")};
  BagSource source(path("odometry.mcap"), options, &diagnostics_);
  const std::optional<DepthSample> sample = source.nextDepth();
  ASSERT_TRUE(sample);
  EXPECT_EQ(sample->depth_m, 7.25);
  EXPECT_EQ(sample->time, at(0));
}

}  // namespace
}  // namespace lodeline
