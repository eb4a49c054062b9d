#include "lodeline/evaluation/trajectory/pose_table.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/trajectory.h"

namespace lodeline {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr double kStart_s = 1700000000.0;

class PoseTableTest : public ::testing::Test {
 protected:
  Trajectory read(const std::string& text, std::optional<TrajectoryFormat> format = std::nullopt) {
    diagnostics_ = Diagnostics();
    return readPoseTable(bytesInMemory(text), "poses.txt", format, diagnostics_);
  }

  /// One row per pose of `truth_`. `layout` has the fields {ns} {us} {ms} {s} {x} {y} {z} {qx} {qy} {qz}
  /// {qw}. {r0} {r1} {r2} are rows of the matrix, {i} is the row's number.
  std::string rows(const std::string& layout) const {
    std::string text;
    int i = 0;
    for (const StampedPose& pose : truth_.poses) {
      const int64_t ns = pose.time.nanoseconds();
      const Vec3& p = pose.world_from_body.translation;
      const Quat& q = pose.world_from_body.rotation;
      const Mat3 r = q.toRotationMatrix();
      const auto row = [&](int k) {
        return fmt::format("{:.12f} {:.12f} {:.12f} {:.12f}", r(k, 0), r(k, 1), r(k, 2), p[k]);
      };
      text += fmt::format(
          fmt::runtime(layout), fmt::arg("ns", ns), fmt::arg("us", ns / 1000), fmt::arg("ms", ns / 1000000),
          fmt::arg("s", fmt::format("{}.{:09}", ns / 1000000000, ns % 1000000000)), fmt::arg("x", p.x()),
          fmt::arg("y", p.y()), fmt::arg("z", p.z()), fmt::arg("qx", q.x()), fmt::arg("qy", q.y()),
          fmt::arg("qz", q.z()), fmt::arg("qw", q.w()), fmt::arg("r0", row(0)), fmt::arg("r1", row(1)),
          fmt::arg("r2", row(2)), fmt::arg("i", i++));
      text += "\n";
    }
    return text;
  }

  void expectTruth(const Trajectory& read, const std::string& what) {
    ASSERT_EQ(read.size(), truth_.size()) << what;
    for (std::size_t i = 0; i < read.size(); ++i) {
      ASSERT_EQ(read.poses[i].time, truth_.poses[i].time) << what;
      ASSERT_LT((read.poses[i].world_from_body.matrix() - truth_.poses[i].world_from_body.matrix()).norm(),
                1e-9)
          << what;
    }
  }

  std::string failure(const std::string& text) {
    try {
      read(text);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no InputError";
  }

  Trajectory truth_ = test::bend(60, kStart_s);
  Diagnostics diagnostics_;
};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
  return text;
}

TEST_F(PoseTableTest, ReadsTheLayoutsOfManyPrograms) {
  const std::string tum = "{x} {y} {z} {qx} {qy} {qz} {qw}";
  const std::string w_first = "{x},{y},{z},{qw},{qx},{qy},{qz}";
  const std::string w_last = "{x},{y},{z},{qx},{qy},{qz},{qw}";
  const std::string okvis =
      "timestamp, p_WS_W_x, p_WS_W_y, p_WS_W_z, q_WS_x, q_WS_y, q_WS_z, q_WS_w, v_WS_W_x\n";
  const std::pair<const char*, std::string> layouts[] = {
      {"TUM", rows("{s} " + tum)},
      {"TUM with a header", "# timestamp tx ty tz qx qy qz qw\n" + rows("{s} " + tum)},
      {"our own", "# timestamp [s] x y z qx qy qz qw\n" + rows("{s} " + tum)},
      {"ORB-SLAM3", rows("{ns}.000000 " + tum)},
      {"EuRoC",
       "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], q_RS_y [], q_RS_z []\n" +
           rows("{ns}," + w_first)},
      {"EuRoC without a header", rows("{ns}," + w_first + ",0.1,0.2,0.3,0,0,0,0,0,0")},
      {"OKVIS2", okvis + rows("{ns}, " + w_last + ", 0.5")},
      {"OKVIS2 with #", "#" + okvis + rows("{ns}, " + w_last + ", 0.5")},
      {"VINS-Fusion", rows("{ns}," + w_first + ",")},
      {"VINS-Mono", rows("{ns}," + w_first + ",0.1,0.2,0.3,")},
      {"Kimera", "#timestamp,x,y,z,qw,qx,qy,qz,vx,vy,vz,bgx,bgy,bgz,bax,bay,baz\n" +
                     rows("{ns}," + w_first + ",1,2,3,0,0,0,0,0,0")},
      {"OpenVINS",
       "# timestamp(s) q p v bg ba cam_imu_dt num_cam cam0_k cam0_d cam0_rot cam0_trans .... etc\n" +
           rows("{s} {qx} {qy} {qz} {qw} {x} {y} {z} 1 2 3 0 0 0 0 0 0 0.01 2 400 400 320 240")},
      {"maplab",
       "timestamp [ns], vertex index, position x [m], position y [m], position z [m], quaternion x, "
       "quaternion y, quaternion z, quaternion w\n" +
           rows("{ns}, {i}, " + w_last)},
      {"rostopic",
       "%time,field.header.seq,field.header.stamp,field.header.frame_id,field.pose.pose.position.x,"
       "field.pose.pose.position.y,field.pose.pose.position.z,field.pose.pose.orientation.x,"
       "field.pose.pose.orientation.y,field.pose.pose.orientation.z,field.pose.pose.orientation.w,"
       "field.pose.covariance0\n" +
           rows("1,{i},{ns},world," + w_last + ",0")},
      {"pandas", ",timestamp,tx,ty,tz,qx,qy,qz,qw\n" + rows("{i},{ns}," + w_last)},
      {"time and 3x4", rows("{s} {r0} {r1} {r2}")},
      {"time and 4x4", rows("{s} {r0} {r1} {r2} 0 0 0 1")},
      {"semicolons, decimal commas", replaced(replaced(rows("{s} " + tum), " ", ";"), ".", ",")},
      {"maplab, frame before the axis",
       "timestamp [ns], vertex-id, mission-id, p_G_Ix [m], p_G_Iy [m], p_G_Iz [m], q_G_Ix, q_G_Iy, q_G_Iz, "
       "q_G_Iw\n" +
           rows("{ns}, {i}, a1b2, " + w_last)},
      {"millimetres", "timestamp [ns],x [mm],y [mm],z [mm],qx,qy,qz,qw\n" +
                          rows("{ns},{x}e3,{y}e3,{z}e3,{qx},{qy},{qz},{qw}")},
      {"microseconds by name", "timestamp_us,tx,ty,tz,qx,qy,qz,qw\n" + rows("{us}," + w_last)},
      {"microseconds by size", rows("{us} " + tum)},
      {"milliseconds by size", rows("{ms} " + tum)},
      {"UTF-8 with its mark", "\xEF\xBB\xBF" + rows("{s} " + tum)},
      {"CR alone", replaced(rows("{s} " + tum), "\n", "\r")},
  };
  for (const auto& [what, text] : layouts) {
    expectTruth(read(text), what);
    for (const Finding& finding : diagnostics_.ranked()) {
      EXPECT_EQ(finding.severity, Severity::Notice) << what << ": " << finding.first_message;
    }
  }
}

TEST_F(PoseTableTest, ReadsUtf16) {
  std::string text = "\xFF\xFE";
  for (const char c : rows("{s} {x} {y} {z} {qx} {qy} {qz} {qw}")) text += std::string{c, '\0'};
  expectTruth(read(text), "UTF-16");
}

TEST_F(PoseTableTest, TakesTheUnitThatThePosesRateAllows) {
  std::string uptime_ms;
  for (int i = 0; i < 50; ++i) uptime_ms += fmt::format("{} {} 0 0 0 0 0 1\n", 1500000 + i * 50000, i);
  const Trajectory poses = read(uptime_ms);  // in seconds the interval of the poses would be 14 hours
  EXPECT_EQ((poses.poses[1].time - poses.poses[0].time).nanoseconds(), 50'000'000);
  EXPECT_EQ(diagnostics_.count("time_unit"), 1);
  for (const int64_t first : {134'247'456'000'000'000, 639'158'688'000'000'000, 17'802'720'000'000'000}) {
    std::string ticks;
    for (int i = 0; i < 50; ++i) ticks += fmt::format("{} {} 0 0 0 0 0 1\n", first + i * 500000, i);
    const Trajectory since_1970 = read(ticks);
    EXPECT_EQ(since_1970.poses[1].time.nanoseconds(), 1'780'272'000'050'000'000) << first;
    EXPECT_EQ(diagnostics_.count("time_unit"), 1) << first;
  }
  // A header that states nanoseconds, with times in seconds.
  const Trajectory stated = read(
      "timestamp [ns],x,y,z,qw,qx,qy,qz\n1403636579.70,0,0,0,1,0,0,0\n1403636579.75,1,0,0,1,0,0,0\n"
      "1403636579.80,1,0,0,1,0,0,0\n");
  EXPECT_EQ((stated.poses[1].time - stated.poses[0].time).nanoseconds(), 50'000'000);
  EXPECT_EQ(diagnostics_.count("time_unit"), 1);
}

TEST_F(PoseTableTest, SaysWhenItGuessesTheOrderOfTheQuaternion) {
  expectTruth(read(rows("{ns} {x} {y} {z} {qx} {qy} {qz} {qw}")), "nanoseconds between blanks");
  EXPECT_EQ(diagnostics_.count("quaternion_order"), 1);
  expectTruth(read(rows("{ns} {x} {y} {z} {qw} {qx} {qy} {qz}"), TrajectoryFormat::Euroc), "asked for");
  EXPECT_EQ(diagnostics_.count("quaternion_order"), 0);
}

TEST_F(PoseTableTest, RefusesWhatItCannotTell) {
  EXPECT_THAT(
      failure("time,x,y,z,roll,pitch,yaw\n1,2,3,4,5,6,7\n"),
      AllOf(HasSubstr("no known trajectory layout"), HasSubstr("'time,x,y,z,roll,pitch,yaw' names no")));
  EXPECT_THAT(failure("t [s],x [deg],y [deg],z [deg],qx,qy,qz,qw\n1,1,2,3,0,0,0,1\n"), HasSubstr("'deg'"));
  EXPECT_THAT(failure("speed,course\n"), HasSubstr("neither a row of a trajectory"));
  EXPECT_THAT(failure("1 1 2 3 0 0 0 1 9\n2 1 2 3 0 0 0 1\n"),
              HasSubstr("poses.txt:2: 8 columns where 9 are due"));
  EXPECT_THAT(failure("t [fortnight],x,y,z,qx,qy,qz,qw\n1,1,2,3,0,0,0,1\n"), HasSubstr("fortnight"));
}

TEST_F(PoseTableTest, RowsWithoutTimesPairOnlyWithAsManyOthers) {
  const Trajectory all = read(rows("{r0} {r1} {r2}"));
  EXPECT_EQ(all.time_base, TimeBase::Index);
  EXPECT_EQ(all.rows, 60u);
  truth_.poses.resize(12);
  const Trajectory keyframes = read(rows("{r0} {r1} {r2}"));
  EXPECT_THROW(associate(keyframes, all, {}), InputError);
  EXPECT_EQ(associate(all, all, {}).size(), 60u);
}

}  // namespace
}  // namespace lodeline
