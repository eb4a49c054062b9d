#include "lodeline/trajectory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/image_times.h"
#include "lodeline/evaluation/trajectory/read_body_from_camera.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"

namespace lodeline {
namespace {

using ::testing::HasSubstr;

class ReadTrajectoryTest : public ::testing::Test {
 protected:
  Trajectory read(const std::string& content, const std::string& name = "trajectory.txt") {
    return readTrajectory(folder_.write(name, content), options_, diagnostics_);
  }

  /// Message of the InputError that the reader throws.
  std::string failure(const std::string& content, const std::string& name = "trajectory.txt") {
    try {
      read(content, name);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no InputError";
  }

  test::TemporaryFolder folder_;
  TrajectoryReadOptions options_;
  Diagnostics diagnostics_;
};

TEST_F(ReadTrajectoryTest, Tum) {
  const Trajectory t = read("# time x y z qx qy qz qw\n1403715529.112143517 1 2 3 0.5 -0.5 0.5 -0.5\n");
  ASSERT_EQ(t.size(), 1u);
  EXPECT_EQ(t.poses[0].time.nanoseconds(), 1403715529112143517);
  EXPECT_EQ(t.poses[0].world_from_body.translation, Vec3(1, 2, 3));
  EXPECT_DOUBLE_EQ(t.poses[0].world_from_body.rotation.w(), -0.5);
  EXPECT_DOUBLE_EQ(t.poses[0].world_from_body.rotation.y(), -0.5);
}

TEST_F(ReadTrajectoryTest, TumWithCommasCrlfBlankLinesExponentsAndFurtherColumns) {
  const Trajectory t =
      read("\r\n1.403715529112143517e+09, 1,2,3, 0,0,0,1, 9, 9\r\n\r\n1403715530,1,2,3,0,0,0,1,9,9");
  ASSERT_EQ(t.size(), 2u);
  EXPECT_EQ(t.poses[0].time.nanoseconds(), 1403715529112143517);
}

TEST_F(ReadTrajectoryTest, TumCompressed) {
  const auto path = folder_.path() / "trajectory.txt.gz";
  gzFile file = gzopen(path.c_str(), "wb");
  gzputs(file, "1.5 1 2 3 0 0 0 1\n");
  gzclose(file);
  EXPECT_EQ(readTrajectory(path, {}, diagnostics_).size(), 1u);
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 9);
  EXPECT_THROW(readTrajectory(path, {}, diagnostics_), InputError);
}

TEST_F(ReadTrajectoryTest, Euroc) {
  const Trajectory t =
      read("#timestamp, p_x [m]\n1403715888379057920,1,2,3,0.5,0.5,-0.5,0.5,0.1,0.2,0.3,0,0,0,0,0,0\n");
  ASSERT_EQ(t.size(), 1u);
  EXPECT_EQ(t.poses[0].time.nanoseconds(), 1403715888379057920);
  EXPECT_DOUBLE_EQ(t.poses[0].world_from_body.rotation.y(), -0.5);
}

TEST_F(ReadTrajectoryTest, KittiCountsRowsAndHasYDown) {
  const Trajectory t = read("1 0 0 4 0 1 0 5 0 0 1 6\n0 -1 0 7 1 0 0 8 0 0 1 9\n");
  ASSERT_EQ(t.size(), 2u);
  EXPECT_EQ(t.time_base, TimeBase::Index);
  EXPECT_EQ(t.up, WorldUp::MinusY);
  EXPECT_EQ(t.poses[1].world_from_body.translation, Vec3(7, 8, 9));
  EXPECT_NEAR(Eigen::AngleAxisd(t.poses[1].world_from_body.rotation).angle(), M_PI / 2, 1e-12);
}

TEST_F(ReadTrajectoryTest, NamesFileAndLineOfWhatItCannotRead) {
  EXPECT_THAT(failure("1 1 2 3 0 0 0 1\n2 1 2 3 0 0 0 x\n"), HasSubstr("trajectory.txt:2"));
  EXPECT_THAT(failure("1 1 2 3 0 0 0 1\n# note\n2 1 2 3\n3 1 2 3 0 0 0 1\n"), HasSubstr("trajectory.txt:3"));
  EXPECT_THAT(failure("abc 1 2 3 0 0 0 1\n"), HasSubstr("time in seconds"));
  EXPECT_THAT(failure("1e30 1 2 3 0 0 0 1\n"), HasSubstr("expected a time"));
  EXPECT_THAT(failure("nan 1 2 3 0 0 0 1\n"), HasSubstr("time in seconds"));
  EXPECT_THAT(failure("1 2 3\n"), HasSubstr("no known trajectory layout"));
  EXPECT_THAT(failure(""), HasSubstr("no data lines"));
  EXPECT_THAT(failure("# only a comment\n"), HasSubstr("no data lines"));
  EXPECT_THAT(failure("1 1 2 3 0 0 0 0.7\n"), HasSubstr("column order"));
  EXPECT_THAT(failure("1 0 0 0 0 1 0 0 0 0 2 0\n"), HasSubstr("not a rotation"));
  EXPECT_THAT(failure("1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 0 0\n"),
              HasSubstr("13 columns where 12 are due"));
}

TEST_F(ReadTrajectoryTest, MissingFilesAndFoldersWithoutTrajectory) {
  EXPECT_THROW(readTrajectory(folder_.path() / "absent.txt", {}, diagnostics_), InputError);
  EXPECT_THROW(readTrajectory(folder_.path(), {}, diagnostics_), InputError);
}

TEST_F(ReadTrajectoryTest, LeavesOutACutOffLastLineWithAWarning) {
  EXPECT_EQ(read("1 1 2 3 0 0 0 1\n2 1 2 3 0 0").size(), 1u);
  EXPECT_EQ(diagnostics_.count("truncated_line"), 1);
  EXPECT_THAT(failure("1 1 2 3 0 0 0 1\n2 1 2 3 0 0\n"), HasSubstr("6 columns"));
}

TEST_F(ReadTrajectoryTest, LeavesOutLostPosesWithAWarning) {
  EXPECT_EQ(read("1 nan nan nan nan nan nan nan\n2 1 2 3 0 0 0 1\n").size(), 1u);
  EXPECT_EQ(diagnostics_.count("pose_not_finite"), 1);
  EXPECT_THAT(failure("1 nan nan nan nan nan nan nan\n"), HasSubstr("no poses"));
}

TEST_F(ReadTrajectoryTest, OrdersByTimeWithAWarning) {
  const Trajectory t = read("2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n");
  EXPECT_EQ(t.poses[0].time, Time::fromSeconds(1.0));
  EXPECT_EQ(diagnostics_.count("trajectory_disorder"), 1);
}

TEST_F(ReadTrajectoryTest, FormatCanBeForced) {
  options_.format = TrajectoryFormat::Tum;
  EXPECT_EQ(read("1 1 2 3 0 0 0 1 9 9 9 9\n").time_base, TimeBase::Stamps);
  EXPECT_EQ(trajectoryFormatFromString("kitti"), TrajectoryFormat::Kitti);
  EXPECT_THROW(trajectoryFormatFromString("tun"), UsageError);
}

TEST_F(ReadTrajectoryTest, FindsTheTrajectoryInFolders) {
  folder_.write("run/trajectory.tum", "1 1 2 3 0 0 0 1\n");
  folder_.write("recording/mav0/state_groundtruth_estimate0/data.csv", "1403715888379057920,1,2,3,1,0,0,0\n");
  EXPECT_EQ(findTrajectory(folder_.path() / "run").file, folder_.path() / "run/trajectory.tum");
  folder_.write("run/trajectory_refined.tum", "1 4 5 6 0 0 0 1\n");
  EXPECT_EQ(findTrajectory(folder_.path() / "run").file, folder_.path() / "run/trajectory_refined.tum");
  const auto truth = folder_.path() / "recording/mav0/state_groundtruth_estimate0/data.csv";
  EXPECT_EQ(findTrajectory(folder_.path() / "recording").file, truth);
  EXPECT_EQ(findTrajectory(folder_.path() / "recording/mav0").file, truth);
}

// Camera rotated by 180 degrees about z in the world, at (1, 2, 3): camera_from_world t = -R^T p = (1, 2,
// -3).
const char* const kColmapText =
    "# Image list with two lines of data per image:\n"
    "#   IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n"
    "7 0 0 0 1 1 2 -3 1 cam0/1403636580763555584.png\n"
    "10.5 20.5 -1 30.5 40.5 12\n"
    "3 1 0 0 0 0 0 0 1 cam0/1403636579763555584.png\n"
    "\n";

TEST_F(ReadTrajectoryTest, ColmapTextGivesCameraPosesByTime) {
  const Trajectory t = read(kColmapText, "images.txt");
  ASSERT_EQ(t.size(), 2u);
  EXPECT_EQ(t.poses[0].time.nanoseconds(), 1403636579763555584);
  EXPECT_LT((t.poses[1].world_from_body.translation - Vec3(1, 2, 3)).norm(), 1e-12);
}

TEST_F(ReadTrajectoryTest, ColmapNeedsTimesThatAreTimes) {
  const std::string frames = "1 1 0 0 0 0 0 0 1 frame_0001.png\n\n2 1 0 0 0 0 0 0 1 000002.png\n\n";
  EXPECT_THAT(failure(frames, "images.txt"), HasSubstr("--image-times"));
  options_.image_times = folder_.write("times.txt", "frame_0001.png 10.5\n000002.png 11.5\n");
  EXPECT_EQ(read(frames, "images.txt").poses[1].time, Time::fromSeconds(11.5));
  options_.image_times = folder_.write("data.csv", "#t,name\n1403636579763555584,frame_0001.png\n");
  EXPECT_THAT(failure(frames, "images.txt"), HasSubstr("000002.png"));
  options_.image_times = folder_.write("times.txt", "frame_0001.png 10.5 1\n");
  EXPECT_THAT(failure(frames, "images.txt"), HasSubstr("times.txt:1"));
}

TEST_F(ReadTrajectoryTest, ColmapPosesBecomeBodyPoses) {
  options_.body_from_camera = readBodyFromCamera(folder_.write(
      "sensor.yaml", "T_BS:\n  rows: 4\n  cols: 4\n  data: [0,-1,0,0.5, 1,0,0,0, 0,0,1,0, 0,0,0,1]\n"));
  const Trajectory t = read("3 1 0 0 0 0 0 0 1 12.5.png\n\n", "images.txt");
  EXPECT_EQ(t.poses[0].time, Time::fromSeconds(12.5));
  EXPECT_LT((t.poses[0].world_from_body.translation - Vec3(0, 0.5, 0)).norm(), 1e-12);
  EXPECT_NEAR(Eigen::AngleAxisd(t.poses[0].world_from_body.rotation).angle(), M_PI / 2, 1e-12);
}

TEST_F(ReadTrajectoryTest, BodyFromCameraMustBeThere) {
  EXPECT_THROW(readBodyFromCamera(folder_.write("a.yaml", "rate_hz: 20\n")), InputError);
  EXPECT_THROW(readBodyFromCamera(folder_.write("b.yaml", "T_BS: [1, 2\n")), InputError);
  EXPECT_THROW(
      readBodyFromCamera(folder_.write("c.yaml", "T_BS: {data: [a,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}\n")),
      InputError);
  EXPECT_THROW(readBodyFromCamera(folder_.path() / "absent.yaml"), InputError);
}

template <typename T>
void append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

std::string colmapBinary() {
  std::string bytes;
  append<uint64_t>(bytes, 1);
  append<int32_t>(bytes, 7);
  for (const double value : {0.0, 0.0, 0.0, 1.0, 1.0, 2.0, -3.0}) append(bytes, value);
  append<int32_t>(bytes, 1);
  bytes += std::string("1403636580763555584.png") + '\0';
  append<uint64_t>(bytes, 2);
  bytes += std::string(2 * 24, '\1');
  return bytes;
}

TEST_F(ReadTrajectoryTest, ColmapBinary) {
  const Trajectory t = read(colmapBinary(), "images.bin");
  ASSERT_EQ(t.size(), 1u);
  EXPECT_EQ(t.poses[0].time.nanoseconds(), 1403636580763555584);
  EXPECT_LT((t.poses[0].world_from_body.translation - Vec3(1, 2, 3)).norm(), 1e-12);
}

TEST_F(ReadTrajectoryTest, ColmapBinaryCutOffAnywhereIsAnError) {
  const std::string whole = colmapBinary();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_THAT(failure(whole.substr(0, size), "images.bin"), HasSubstr("images.bin")) << size;
  }
}

TEST(ImageStamps, AreReadFromFileOrFolder) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("data.csv", "#timestamp [ns],filename\r\n1403636579763555584,a.png\r\n");
  EXPECT_EQ(readImageStamps(file).size(), 1u);
  EXPECT_EQ(readImageStamps(folder.path()).front().nanoseconds(), 1403636579763555584);
  EXPECT_THROW(readImageStamps(folder.write("data.csv", "1.5,a.png\n")), InputError);
}

TEST(WriteTrajectory, TumReadsBack) {
  const test::TemporaryFolder folder;
  const Trajectory written = test::bend(20, 1403715529.5);
  writeTum(written, folder.path() / "t.tum");
  Diagnostics diagnostics;
  const Trajectory read = readTrajectory(folder.path() / "t.tum", {}, diagnostics);
  ASSERT_EQ(read.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read.poses[i].time, written.poses[i].time);
    EXPECT_LT((read.poses[i].world_from_body.matrix() - written.poses[i].world_from_body.matrix()).norm(),
              1e-8);
  }
  EXPECT_THROW(writeTum(written, folder.path() / "nowhere" / "t.tum"), InputError);
}

}  // namespace
}  // namespace lodeline
