#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <functional>
#include <map>
#include <memory>

#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/io/rosbag/bag_kinds.h"
#include "lodeline/output/foxglove/foxglove_file.h"
#include "lodeline/output/foxglove/foxglove_messages.h"
#include "lodeline/output/foxglove/foxglove_run.h"
#include "lodeline/output/foxglove/state_messages.h"

// Tests of a run as an MCAP file: frames, times, numbers of messages, and damaged folders.

namespace lodeline::foxglove {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// First stamp; the run has four poses, one a second.
constexpr int64_t kFirst_s = 1795255200;
constexpr int kCount = 4;

class FoxgloveTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_.write("run/trajectory.tum", poses(0.0));
    folder_.write("run/run.json",
                  R"({"program": "lodeline 0.1.0", "findings": [
                    {"severity": "serious", "kind": "imu_gap", "message": "imu0: nothing", "count": 2},
                    {"severity": "notice", "kind": "other", "message": "of note", "count": 1}]})");
    std::string states = "#timestamp [ns],status,tracks,q_w,q_x,q_y,q_z,v_x [m/s],cov_pose_00,field_x [T]\n";
    for (int i = 0; i < kCount; ++i) {
      states += fmt::format("{},{},{},1,0,0,0,0.5,1,nan\n", (kFirst_s + i) * 1'000'000'000 + 250'000'000,
                            i == 2 ? "inertial" : "tracking", 100 + i);
    }
    folder_.write("run/states.csv", states);
    folder_.write("run/landmarks.ply", landmarks());
  }

  /// Steps of 1 m along x; the rotation is a quarter turn about z.
  static std::string poses(double shift_y_m) {
    std::string text = "# timestamp [s] x y z qx qy qz qw\n";
    for (int i = 0; i < kCount; ++i) {
      text += fmt::format("{}.25 {} {} -2 0 0 0.70710678118654752 0.70710678118654752\n", kFirst_s + i, i,
                          shift_y_m * i);
    }
    return text;
  }
  static std::string landmarks() {
    std::string text =
        "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
        "property float z\nproperty int observations\nend_header\n";
    for (const float x : {1.5f, -2.5f}) {
      const auto word = [&text](const auto& value) {
        text.append(reinterpret_cast<const char*>(&value), sizeof(value));
      };
      word(x);
      word(2.0f);
      word(3.0f);
      word(int32_t{7});
    }
    return text;
  }

  std::filesystem::path run() const { return folder_.path() / "run"; }
  std::filesystem::path write(bool with_pictures = false) {
    const std::filesystem::path file = folder_.path() / "run.mcap";
    writeRun(readRun(run(), with_pictures, &diagnostics_), file);
    return file;
  }
  static std::string bytes(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  /// All messages of the file by topic.
  std::map<std::string, std::vector<Json>> messages(bool with_pictures = false) {
    const std::unique_ptr<BagFile> bag = openBagFile(write(with_pictures), &of_bag_);
    std::map<std::string, std::vector<Json>> messages;
    for (const BagTopic& topic : bag->topics()) {
      schemas_[topic.connection.topic] = topic.connection.type;
      for (const BagEntry& entry : topic.entries) {
        const Json message = Json::parse(bag->stored(entry).value());
        EXPECT_EQ(message["timestamp"], timeJson(entry.received)) << topic.connection.topic;
        messages[topic.connection.topic].push_back(message);
      }
    }
    return messages;
  }
  static std::vector<Json> between(const std::vector<Json>& transforms, const std::string& parent,
                                   const std::string& child) {
    std::vector<Json> found;
    for (const Json& transform : transforms) {
      if (transform["parent_frame_id"] == parent && transform["child_frame_id"] == child)
        found.push_back(transform);
    }
    return found;
  }
  static std::string errorOf(const std::function<void()>& action) {
    try {
      action();
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  test::TemporaryFolder folder_;
  Diagnostics diagnostics_, of_bag_;
  std::map<std::string, std::string> schemas_;
};

TEST_F(FoxgloveTest, WritesEveryTopicWithItsSchema) {
  auto all = messages();
  std::vector<std::string> topics;
  for (const auto& [topic, schema] : schemas_) topics.push_back(topic + " " + schema);
  EXPECT_THAT(topics, ElementsAre("/landmarks foxglove.PointCloud", "/odometry foxglove.PoseInFrame",
                                  "/path/run foxglove.PosesInFrame", "/states lodeline.State",
                                  "/status foxglove.Log", "/tf foxglove.FrameTransform"));
  EXPECT_EQ(all["/tf"].size(), 4u);
  EXPECT_EQ(all["/odometry"].size(), 4u);
  EXPECT_EQ(all["/path/run"].size(), 1u);
  EXPECT_EQ(all["/states"].size(), 4u);
  EXPECT_TRUE(diagnostics_.ranked().empty());
}

TEST_F(FoxgloveTest, PosesHaveFramesAndTimesOfTheRun) {
  auto all = messages();
  const Json& pose = all["/odometry"][3];
  EXPECT_EQ(pose["timestamp"]["sec"], kFirst_s + 3);
  EXPECT_EQ(pose["timestamp"]["nsec"], 250'000'000);
  EXPECT_EQ(pose["frame_id"], "odom");
  EXPECT_EQ(pose["pose"]["position"], Json({{"x", 3.0}, {"y", 0.0}, {"z", -2.0}}));
  EXPECT_NEAR(pose["pose"]["orientation"]["z"].get<double>(), std::sqrt(0.5), 1e-12);
  const std::vector<Json> body = between(all["/tf"], "odom", "base_link");
  ASSERT_EQ(body.size(), 4u);
  EXPECT_EQ(body[3]["translation"], pose["pose"]["position"]);
  EXPECT_EQ(body[3]["rotation"], pose["pose"]["orientation"]);
  const Json& path = all["/path/run"][0];
  EXPECT_EQ(path["timestamp"]["sec"], kFirst_s);
  ASSERT_EQ(path["poses"].size(), 4u);
  EXPECT_EQ(path["poses"][3], pose["pose"]);
}

TEST_F(FoxgloveTest, TheMapCorrectsTheRun) {
  folder_.write("run/trajectory_map.tum", poses(0.5));
  folder_.write("run/trajectory_refined.tum", poses(0.25));
  auto all = messages();
  const std::vector<Json> corrections = between(all["/tf"], "map", "odom");
  ASSERT_EQ(corrections.size(), 4u);
  // map_from_odom applied to the pose in odom gives the pose in the map.
  const Json& t = corrections[3]["translation"];
  EXPECT_NEAR(t["x"].get<double>(), 0.0, 1e-12);
  EXPECT_NEAR(t["y"].get<double>(), 1.5, 1e-12);
  EXPECT_NEAR(t["z"].get<double>(), 0.0, 1e-12);
  EXPECT_NEAR(corrections[3]["rotation"]["w"].get<double>(), 1.0, 1e-12);
  EXPECT_EQ(between(all["/tf"], "map", "refined").size(), 1u);
  EXPECT_EQ(all["/path/map"][0]["frame_id"], "map");
  EXPECT_EQ(all["/path/map"][0]["poses"][2]["position"]["y"], 1.0);
  EXPECT_EQ(all["/path/refined"][0]["frame_id"], "refined");
  EXPECT_EQ(all["/path/refined"][0]["poses"][2]["position"]["y"], 0.5);
}

TEST_F(FoxgloveTest, WithoutAMapTheRefinedPathHangsOnTheRun) {
  folder_.write("run/trajectory_refined.tum", poses(0.25));
  folder_.write("run/trajectory_map.tum", "# timestamp [s] x y z qx qy qz qw\n");  // nothing was recognized
  auto all = messages();
  const std::vector<Json> refined = between(all["/tf"], "odom", "refined");
  ASSERT_EQ(refined.size(), 1u);
  EXPECT_EQ(refined[0]["translation"], Json({{"x", 0.0}, {"y", 0.0}, {"z", 0.0}}));
  EXPECT_EQ(all.count("/path/map"), 0u);
  EXPECT_EQ(diagnostics_.count("path_empty"), 1);
}

TEST_F(FoxgloveTest, LandmarksAreAPackedCloud) {
  const Json cloud = messages()["/landmarks"][0];
  EXPECT_EQ(cloud["frame_id"], "odom");
  EXPECT_EQ(cloud["point_stride"], 16);
  EXPECT_EQ(cloud["fields"][2], Json({{"name", "z"}, {"offset", 8}, {"type", 7}}));
  EXPECT_EQ(cloud["fields"][3], Json({{"name", "observations"}, {"offset", 12}, {"type", 6}}));
  // 1.5, 2, 3 as floats and 7 as a whole number; then -2.5, 2, 3 and 7.
  EXPECT_EQ(cloud["data"], "AADAPwAAAEAAAEBABwAAAAAAIMAAAABAAABAQAcAAAA=");
}

TEST_F(FoxgloveTest, TheLogHasFindingsAndChangesOfTheStatus) {
  std::vector<std::string> lines;
  const std::vector<Json> log = messages()["/status"];
  for (const Json& message : log) {
    lines.push_back(fmt::format("{} {} {} {}", message["timestamp"]["sec"].get<int64_t>() - kFirst_s,
                                message["level"].get<int>(), message["name"].get<std::string>(),
                                message["message"].get<std::string>()));
  }
  EXPECT_THAT(lines,
              ElementsAre("0 2 lodeline lodeline 0.1.0", "0 4 imu_gap imu0: nothing", "0 2 other of note",
                          "0 2 status tracking", "2 3 status inertial", "3 2 status tracking"));
}

TEST_F(FoxgloveTest, StatesAreNumbersByName) {
  const Json state = messages()["/states"][1];
  EXPECT_EQ(state["tracks"], 101.0);
  EXPECT_EQ(state["v_x_m_per_s"], 0.5);
  EXPECT_EQ(state["status"], "tracking");
  EXPECT_EQ(state["azimuth_of_body_x_deg"], 90.0);  // the body's x axis lies along the world's
  EXPECT_FALSE(state.contains("field_x_T"));        // not a number
  EXPECT_FALSE(state.contains("cov_pose_00"));
  EXPECT_EQ(fieldName("b_a_x [m/s^2]"), "b_a_x_m_per_s2");
}

TEST_F(FoxgloveTest, PicturesComeOnlyWhenAskedFor) {
  folder_.write(fmt::format("run/pictures/{}.jpg", (kFirst_s + 1) * 1'000'000'000), "abc");
  folder_.write("run/pictures/5.jpg", "of another run");
  folder_.write("run/pictures/notes.txt", "no picture");
  EXPECT_EQ(messages().count("/pictures"), 0u);
  auto all = messages(true);
  ASSERT_EQ(all["/pictures"].size(), 1u);
  EXPECT_EQ(all["/pictures"][0]["data"], "YWJj");
  EXPECT_EQ(all["/pictures"][0]["format"], "jpeg");
  EXPECT_EQ(all["/pictures"][0]["timestamp"]["sec"], kFirst_s + 1);
}

TEST_F(FoxgloveTest, GivesTheSameBytesTwice) {
  const std::string first = bytes(write());
  EXPECT_GT(first.size(), 1000u);
  EXPECT_TRUE(bytes(write()) == first);
}

TEST_F(FoxgloveTest, OnlyTheTrajectoryIsNecessary) {
  for (const char* name : {"run.json", "states.csv", "landmarks.ply"}) std::filesystem::remove(run() / name);
  auto all = messages(true);
  EXPECT_EQ(all.size(), 3u);  // no /states, /landmarks, and an empty /status
  EXPECT_EQ(all["/odometry"].size(), 4u);
  for (const char* kind : {"no_run.json", "no_states.csv", "no_landmarks.ply", "no_pictures"}) {
    EXPECT_EQ(diagnostics_.count(kind), 1) << kind;
  }
}

TEST_F(FoxgloveTest, RefusesDamagedFoldersByTheNameOfTheFile) {
  const auto error = [this] { return errorOf([this] { readRun(run(), false, &diagnostics_); }); };
  folder_.write("run/trajectory_map.tum", "1 2 3\n");
  EXPECT_THAT(error(), HasSubstr("trajectory_map.tum"));
  std::filesystem::remove(run() / "trajectory_map.tum");
  folder_.write("run/states.csv", "time,x\n1,2\n");
  EXPECT_THAT(error(), HasSubstr("states.csv:1"));
  std::filesystem::remove(run() / "states.csv");
  folder_.write("run/run.json", R"({"findings": [{"kind": 3}]})");
  EXPECT_THAT(error(), HasSubstr("run.json"));
  folder_.write("run/run.json", "{}");
  folder_.write("run/landmarks.ply", "no PLY");
  EXPECT_THAT(error(), HasSubstr("landmarks.ply"));
  folder_.write("run/trajectory.tum", "-5 0 0 0 0 0 0 1\n-4 0 0 0 0 0 0 1\n");
  EXPECT_THAT(error(), HasSubstr("no times before 1970"));
  std::filesystem::remove(run() / "trajectory.tum");
  EXPECT_THAT(error(), HasSubstr("no trajectory.tum there"));
}

TEST_F(FoxgloveTest, RefusesAFileThatCannotBeWritten) {
  const foxglove::Run read_run = readRun(run(), false, &diagnostics_);
  EXPECT_THAT(errorOf([&] { writeRun(read_run, folder_.path() / "absent" / "run.mcap"); }),
              HasSubstr("cannot be written"));
}

}  // namespace
}  // namespace lodeline::foxglove
