#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "apps/lodeline/tests/test_program.h"
#include "apps/lodeline/tests/test_recording.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/io/calibration/rig_file.h"
#include "lodeline/io/rosbag/test_bag.h"
#include "lodeline/trajectory.h"

// Tests of `lodeline benchmark` on folders in the layout of each public set. Their recording is a rig moved
// by hand in a room, 1.5 s long.

namespace lodeline::test {
namespace {

namespace fs = std::filesystem;

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// Recording, bag and calibration for all tests, since making them takes longer than most of them.
struct SharedRoom {
  TemporaryFolder folder;
  RoomRecording room = writeRoomRecording(folder.path());
  fs::path bag = folder.path() / "room.bag";  ///< with the truth, and room.rig.yaml beside it
  YAML::Node rig;

  SharedRoom() {
    fs::create_directories(room.sensor("state_groundtruth_estimate0"));
    std::ofstream(room.csv("state_groundtruth_estimate0")) << truthCsv();
    const Execution result = runProgram(fmt::format("convert {} {}", quoted(room.data), quoted(bag)));
    if (result.exit_code != 0) throw std::runtime_error(result.output);
    rig = YAML::LoadFile(folder.path() / "room.rig.yaml");
    fs::remove_all(room.sensor("state_groundtruth_estimate0"));
  }

  /// The truth as EuRoC writes it.
  std::string truthCsv() const {
    std::string csv = "#timestamp [ns],p_x [m],p_y [m],p_z [m],q_w,q_x,q_y,q_z\n";
    std::istringstream lines(readText(room.truth));
    for (std::string line; std::getline(lines, line);) {
      if (line.empty() || line[0] == '#') continue;
      std::istringstream fields(line);
      std::string t, x, y, z, qx, qy, qz, qw;
      fields >> t >> x >> y >> z >> qx >> qy >> qz >> qw;
      const size_t point = t.find('.');
      t = t.substr(0, point) + (t.substr(point + 1) + "000000000").substr(0, 9);
      csv += fmt::format("{},{},{},{},{},{},{},{}\n", t, x, y, z, qw, qx, qy, qz);
    }
    return csv;
  }
};

const SharedRoom& shared() {
  static const SharedRoom room;
  return room;
}

class Benchmark : public testing::Test {
 protected:
  Execution benchmark(const std::string& set, const std::string& options = "") const {
    return runProgram(fmt::format("benchmark {} {} -o {} {}", set, quoted(set_), quoted(output_), options));
  }

  /// The line of a sequence in benchmark.csv.
  std::string row(const std::string& sequence) const {
    std::istringstream lines(readText(output_ / "benchmark.csv"));
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with(sequence + ",")) return line;
    }
    return "";
  }

  double causalError_m(const std::string& sequence) const {
    return readJson(output_ / "results" / (sequence + ".default") /
                    "item.json")["evaluation"]["position_rmse_m"];
  }

  /// Expects a complete run with the error of the recording as it is.
  void expectGood(const Execution& result, const std::string& sequence) const {
    ASSERT_EQ(result.exit_code, 0) << result.output;
    EXPECT_THAT(row(sequence), HasSubstr(sequence + ",done,"));
    EXPECT_LT(causalError_m(sequence), 0.01);
  }

  /// Poses of the first camera at every fifth image, with its number in place of the time.
  static std::string cameraTruth() {
    Diagnostics diagnostics;
    const RigFile rig = readRigFiles({shared().folder.path() / "room.rig.yaml"}, &diagnostics);
    const Trajectory truth = readTrajectory(shared().room.truth, {}, diagnostics);
    std::string text;
    for (int i = 0; i < kRoomImages; i += 5) {
      const Time time = Time::fromNanoseconds(roomImageStamp_ns(i));
      const auto pose = std::find_if(truth.poses.begin(), truth.poses.end(), [&](const StampedPose& p) {
        return std::abs((p.time - time).seconds()) < 1e-6;
      });
      if (pose == truth.poses.end()) throw std::runtime_error("no true pose at an image");
      const Rigid3 camera = pose->world_from_body * rig.rig.cameras[0].body_from_camera;
      const Quat& q = camera.rotation;
      text +=
          fmt::format("{}.0 {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}\n", i, camera.translation.x(),
                      camera.translation.y(), camera.translation.z(), q.x(), q.y(), q.z(), q.w());
    }
    return text;
  }

  fs::path file(const std::string& name) const {
    fs::create_directories((set_ / name).parent_path());
    return set_ / name;
  }
  void write(const std::string& name, const std::string& text) const { std::ofstream(file(name)) << text; }
  /// A calibration file with some sensors of the room's rig.
  void writeRig(const std::string& name, const std::vector<std::string>& sensors) const {
    YAML::Node rig;
    for (const std::string& sensor : sensors) rig[sensor] = shared().rig[sensor];
    std::stringstream text;
    text << rig << "\n";
    write(name, text.str());
  }
  /// Links to the readings and images of the room, without its calibration.
  void linkRoom(const std::string& name) const {
    for (const char* sensor : {"cam0", "cam1", "imu0"}) {
      fs::create_symlink(shared().room.csv(sensor), file(fmt::format("{}/mav0/{}/data.csv", name, sensor)));
    }
    for (const char* camera : {"cam0", "cam1"}) {
      fs::create_symlink(shared().room.sensor(camera) / "data",
                         file(fmt::format("{}/mav0/{}/data", name, camera)));
    }
  }

  TemporaryFolder folder_;
  fs::path set_ = folder_.path() / "set", output_ = folder_.path() / "out";
};

TEST_F(Benchmark, EurocIsRunBesidePublishedFiguresAndResumed) {
  fs::create_directory_symlink(shared().room.data, file("machine_hall/MH_01_easy"));
  for (const char* sequence : {"MH_02_easy", "V1_01_easy"}) {
    fs::copy(shared().room.data, file(sequence), fs::copy_options::recursive);
    write(fmt::format("{}/mav0/state_groundtruth_estimate0/data.csv", sequence), shared().truthCsv());
  }
  fs::remove(set_ / "V1_01_easy/mav0/imu0/data.csv");
  const Execution first = benchmark("euroc", "--jobs 2");
  EXPECT_EQ(first.exit_code, 1);
  EXPECT_THAT(first.output, HasSubstr("items failed: 2 of 3"));
  EXPECT_THAT(row("MH_01_easy"), AllOf(HasSubstr("MH_01_easy,done,,,,,0.036,"), HasSubstr("truth is missing"),
                                       HasSubstr("MH_01_easy/mav0/state_groundtruth_estimate0/data.csv")));
  EXPECT_THAT(row("MH_02_easy"), AllOf(HasSubstr(",done,"), HasSubstr(",0.033,\"\"")));
  EXPECT_LT(causalError_m("MH_02_easy"), 0.01);
  EXPECT_THAT(row("V1_01_easy"), AllOf(HasSubstr(",failed,"), HasSubstr("imu0")));
  const std::string markdown = readText(output_ / "benchmark.md");
  EXPECT_THAT(markdown,
              AllOf(HasSubstr("- ORB-SLAM3: Campos"), HasSubstr("Not in the folder: MH_03_medium")));

  // Mended, it goes on with what is missing only, also as a batch.
  fs::copy(shared().room.csv("imu0"), set_ / "V1_01_easy/mav0/imu0/data.csv");
  const Execution batch =
      runProgram(fmt::format("batch {} -o {}", quoted(output_ / "list.yaml"), quoted(output_)));
  EXPECT_THAT(batch.output, HasSubstr("made 1, kept 2, failed 0"));
  const Execution second = benchmark("euroc");
  EXPECT_THAT(second.output, Not(HasSubstr("started")));
  EXPECT_THAT(row("V1_01_easy"), HasSubstr(",done,"));
}

TEST_F(Benchmark, TumViHasItsCalibrationAndTruthInFoldersBeside) {
  linkRoom("dataset-room1_512_16");
  writeRig("dataset-room1_512_16/dso/camchain.yaml", {"cam0", "cam1"});
  writeRig("dataset-room1_512_16/dso/imu_config.yaml", {"imu0"});
  write("dataset-room1_512_16/mav0/mocap0/data.csv", shared().truthCsv());
  expectGood(benchmark("tumvi"), "room1");
  linkRoom("dataset-room2_512_16");
  EXPECT_EQ(benchmark("tumvi").exit_code, 1);
  EXPECT_THAT(row("room1"), HasSubstr(",done,"));
  EXPECT_THAT(row("room2"),
              AllOf(HasSubstr(",broken,"), HasSubstr("dataset-room2_512_16/dso/camchain.yaml")));
}

TEST_F(Benchmark, UzhFpvFoldersAreLinkedToTheUsualLayout) {
  const std::string folder = "indoor_forward_3_snapdragon_with_gt/";
  const RoomRecording& room = shared().room;
  fs::create_directory_symlink(room.sensor("cam0") / "data", file(folder + "img"));
  fs::create_directory_symlink(room.sensor("cam1") / "data", file(folder + "right"));
  std::string left = "# id timestamp image_name\n", right = left;
  for (int i = 0; i < kRoomImages; ++i) {
    const int64_t ns = roomImageStamp_ns(i);
    const std::string stamp = fmt::format("{}.{:09}", ns / 1000000000, ns % 1000000000);
    const std::string& name = room.image_names[static_cast<size_t>(i)];
    left += fmt::format("{} {} img/{}\n", i, stamp, name);
    right += fmt::format("{} {} right/{}\n", i, stamp, name);
  }
  write(folder + "left_images.txt", left);
  write(folder + "right_images.txt", right);
  std::string imu = "# timestamp ang_vel_x ang_vel_y ang_vel_z lin_acc_x lin_acc_y lin_acc_z\n";
  std::istringstream lines(readText(room.csv("imu0")));
  for (std::string line; std::getline(lines, line);) {
    if (line[0] == '#') continue;
    const size_t comma = line.find(',');
    const std::string ns = line.substr(0, comma);
    std::string numbers = line.substr(comma);
    std::replace(numbers.begin(), numbers.end(), ',', ' ');
    imu += ns.substr(0, ns.size() - 9) + "." + ns.substr(ns.size() - 9) + numbers + "\n";
  }
  write(folder + "imu.txt", imu);
  fs::copy_file(room.truth, file(folder + "groundtruth.txt"));
  const std::string calibration = "calib/indoor_forward_calib_snapdragon/";
  writeRig(calibration + "camchain-imucam-..indoor_forward_calib_snapdragon_imu.yaml", {"cam0", "cam1"});
  writeRig(calibration + "imu-..indoor_forward_calib_snapdragon_imu.yaml", {"imu0"});
  expectGood(benchmark("uzhfpv"), "indoor_forward_3_snapdragon");
}

TEST_F(Benchmark, AqualocNumbersItsTrueCameraPosesByImages) {
  const RoomRecording& room = shared().room;
  const std::string raw = "Harbor_sites_sequences/harbor_sequence_02/raw_data/harbor_";
  std::string list = "#timestamp [ns],filename\n";
  for (int i = 0; i < kRoomImages; ++i) {
    const std::string name = fmt::format("frame{:06}.png", i);
    fs::create_symlink(room.image(0, static_cast<size_t>(i)), file(raw + "images_sequence_02/" + name));
    list += fmt::format("{},{}\n", roomImageStamp_ns(i), name);
  }
  write(raw + "img_sequence_02.csv", list);
  fs::copy_file(room.csv("imu0"), file(raw + "imu_sequence_02.csv"));
  writeRig("harbor_calibration_files/harbor_imu_camera_calib.yaml", {"cam0"});
  writeRig("harbor_calibration_files/harbor_imu_noises.yaml", {"imu0"});
  write("harbor_groundtruth_files/new_harbor_colmap_traj_sequence_02.txt", cameraTruth());
  // One camera needs more motion for its scale than there is, so the error itself is not small.
  const Execution result = benchmark("aqualoc");
  EXPECT_THAT(row("harbor_02"), Not(HasSubstr("broken"))) << result.output;
  Diagnostics diagnostics;
  const Trajectory made = readTrajectory(output_ / "sequences/harbor_02/truth.tum", {}, diagnostics);
  const Trajectory truth = readTrajectory(room.truth, {}, diagnostics);
  const PosePairs pairs = associate(made, truth, {});
  ASSERT_EQ(pairs.size(), 7u);
  for (size_t i = 0; i < pairs.size(); ++i) {
    const Rigid3 error = pairs.reference[i].inverse() * pairs.estimate[i];
    EXPECT_LT(error.translation.norm(), 1e-6);
    EXPECT_LT(Eigen::AngleAxisd(error.rotation).angle(), 1e-6);
  }

  write("harbor_groundtruth_files/new_harbor_colmap_traj_sequence_02.txt", "99.0 0 0 0 0 0 0 1\n");
  EXPECT_EQ(benchmark("aqualoc").exit_code, 1);
  EXPECT_THAT(row("harbor_02"),
              AllOf(HasSubstr("_02.txt:1: image 99.0 is not listed in"), HasSubstr("img_sequence_02.csv")));
}

struct BagCase {
  const char* set;
  const char* sequence;
  const char* bag;
  const char* topics;  ///< OLD=NEW
};

class BenchmarkOfBags : public Benchmark, public testing::WithParamInterface<BagCase> {
 protected:
  void SetUp() override {
    if (!hasRosbag()) GTEST_SKIP() << kRosbagMissing;
  }
  void writeBag(const std::string& topics) const {
    runRosbag(fmt::format("rename {} {} {}", quoted(shared().bag), quoted(file(GetParam().bag)), topics));
  }
};

TEST_P(BenchmarkOfBags, IsReadByItsTopicsWithItsTruth) {
  writeBag(GetParam().topics);
  const std::string name = GetParam().sequence;
  // The calibration beside a bag replaces that of the set, which is of other cameras.
  std::string rig = readText(shared().folder.path() / "room.rig.yaml");
  const std::string stem = fs::path(GetParam().bag).replace_extension().string();
  YAML::Node bare = YAML::Load(rig);
  for (const char* sensor : {"cam0", "cam1", "imu0"}) bare[sensor].remove("topic");
  std::stringstream text;
  text << bare;
  write(stem + ".rig.yaml", text.str());
  if (std::string(GetParam().set) == "hilti22") {
    fs::copy_file(shared().room.truth, file("ground_truth/" + name + "_imu.txt"));
  }
  const Execution result = benchmark(GetParam().set);
  ASSERT_EQ(result.exit_code, 0) << result.output;
  EXPECT_THAT(row(name), HasSubstr(name + ",done,"));
  // The bag holds poses of the body, which the Tank's are not: they are off by the rotation of the camera.
  if (std::string(GetParam().set) != "tank") {
    EXPECT_LT(causalError_m(name), 0.01);
  }
}

TEST_P(BenchmarkOfBags, ABagWithoutItsTopicsOrCalibrationIsARow) {
  fs::create_directories(set_);
  fs::copy_file(shared().bag, file(GetParam().bag));
  const Execution result = benchmark(GetParam().set);
  EXPECT_EQ(result.exit_code, 1);
  const std::string line = row(GetParam().sequence);
  const bool is_tank = std::string(GetParam().set) == "tank";  // the set has its calibration
  EXPECT_THAT(line, HasSubstr(is_tank ? "truth is missing: topic /apriltag_slam/GT"
                                      : ",broken,,,,,\"calibration is missing: "));
}

INSTANTIATE_TEST_SUITE_P(
    Sets, BenchmarkOfBags,
    testing::Values(BagCase{"uzhfpv", "outdoor_45_1_snapdragon", "outdoor_45_1_snapdragon_with_gt.bag",
                            "/cam0/image_raw=/snappy_cam/stereo_l /cam1/image_raw=/snappy_cam/stereo_r "
                            "/imu0=/snappy_imu /ground_truth/pose=/groundtruth/pose"},
                    BagCase{"hilti22", "exp14_basement_2", "exp14_basement_2.bag",
                            "/cam0/image_raw=/alphasense/cam0/image_raw "
                            "/cam1/image_raw=/alphasense/cam1/image_raw /imu0=/alphasense/imu"},
                    BagCase{"tank", "Structure_Easy", "Structure_Easy.bag",
                            "/cam0/image_raw=/camera/left/image_dehazed/compressed "
                            "/cam1/image_raw=/camera/right/image_dehazed/compressed /imu0=/imu/data "
                            "/ground_truth/pose=/apriltag_slam/GT:odometry"}),
    [](const auto& info) { return std::string(info.param.set); });

TEST(BenchmarkUsage, WrongNamesAndEmptyFoldersAreTold) {
  const TemporaryFolder folder;
  const Execution set = runProgram("benchmark eurok " + quoted(folder.path()));
  EXPECT_EQ(set.exit_code, 2);
  EXPECT_THAT(set.output, HasSubstr("did you mean 'euroc'?"));
  const Execution empty =
      runProgram(fmt::format("benchmark tank {} -o {}", quoted(folder.path()), quoted(folder.path() / "o")));
  EXPECT_EQ(empty.exit_code, 1);
  EXPECT_THAT(empty.output, HasSubstr("no sequence of Tank is here; looked for Structure_Easy"));
  EXPECT_FALSE(fs::exists(folder.path() / "o"));
  const Execution missing = runProgram("benchmark tank " + quoted(folder.path() / "none"));
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_THAT(missing.output, HasSubstr("there is no such folder"));
}

}  // namespace
}  // namespace lodeline::test
