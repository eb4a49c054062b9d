#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "apps/lodeline/tests/survey/test_cave_map.h"
#include "apps/lodeline/tests/test_program.h"
#include "lodeline/evaluation/trajectory/test_trajectories.h"

// Tests of `lodeline survey` with the scanning sonar of a dive.

namespace lodeline {
namespace {

using test::Execution;
using test::runProgram;
using ::testing::HasSubstr;

constexpr double kRadius_m = 2.0;  // of the passage
constexpr double kSonarRate_hz = 20.0;

/// Poses of a dive by its odometry, with straight motion between its keyframes.
class Odometry {
 public:
  Odometry(const MapFile& map, const std::string& dive) {
    map.forEachKeyframe(map.findDive(dive)->id, [&](const StoredKeyframe& row) {
      poses_.push_back({row.keyframe.time, row.keyframe.odom_from_body});
    });
  }
  double duration_s() const { return (poses_.back().time - poses_.front().time).seconds(); }
  Time start() const { return poses_.front().time; }

  /// `along`: direction of the passage there, in the odometry's world.
  Rigid3 at(double time_s, Vec3* along) const {
    size_t i = 0;
    while (i + 2 < poses_.size() && (poses_[i + 1].time - start()).seconds() <= time_s) ++i;
    const Rigid3 &a = poses_[i].world_from_body, &b = poses_[i + 1].world_from_body;
    const double begin_s = (poses_[i].time - start()).seconds();
    const double share = (time_s - begin_s) / (poses_[i + 1].time - poses_[i].time).seconds();
    *along = (b.translation - a.translation).normalized();
    return {a.rotation.slerp(share, b.rotation), a.translation + share * (b.translation - a.translation)};
  }

 private:
  std::vector<StampedPose> poses_;
};

class SurveySonarTest : public ::testing::Test {
 protected:
  SurveySonarTest() : cave_(folder_.path() / "cave.db", 5) {}

  /// The result of a run of a dive, in a world of another place and north, with a sonar that scans across the
  /// passage: a tube about the way.
  void writeDive(const std::string& dive) const {
    const Odometry odometry(MapFile::open(folder_.path() / "cave.db", MapFile::Access::Read), dive);
    const Rigid3 elsewhere(Quat(Eigen::AngleAxisd(0.7, Vec3::UnitZ())), Vec3(30.0, -12.0, 4.0));
    std::string poses, echoes = "#timestamp [ns],range [m],angle [rad]\n";
    const Mat3 body_from_sonar = (Mat3() << 0, 0, 1, 1, 0, 0, 0, 1, 0).finished();
    for (int i = 0; i < odometry.duration_s() * kSonarRate_hz; ++i) {
      const double time_s = i / kSonarRate_hz, angle_rad = 0.4 * time_s * 2.0 * std::numbers::pi / 2.0;
      Vec3 along;
      const Rigid3 pose = odometry.at(time_s, &along);
      const Time time = odometry.start() + Duration::fromSeconds(time_s);
      const Rigid3 shown = elsewhere * pose;
      const Quat& q = shown.rotation;
      poses += fmt::format("{}.{:09d} {:.6f} {:.6f} {:.6f} {:.9f} {:.9f} {:.9f} {:.9f}\n",
                           time.nanoseconds() / 1'000'000'000, time.nanoseconds() % 1'000'000'000,
                           shown.translation.x(), shown.translation.y(), shown.translation.z(), q.x(), q.y(),
                           q.z(), q.w());
      const Vec3 beam =
          pose.rotation * (body_from_sonar * Vec3(std::cos(angle_rad), std::sin(angle_rad), 0.0));
      const double range_m = kRadius_m / (beam - beam.dot(along) * along).norm();
      if (range_m < 3.0 * kRadius_m)
        echoes += fmt::format("{},{:.4f},{:.6f}\n", time.nanoseconds(), range_m, angle_rad);
    }
    folder_.write(dive + "/trajectory.tum", poses);
    folder_.write(dive + "/run.json", "{}");
    const std::string recording = dive + "_recording/mav0/";
    std::string imu = "#timestamp [ns],w_x,w_y,w_z,a_x,a_y,a_z\n";
    for (int i = 0; i < 200; ++i)
      imu += fmt::format("{},0,0,0.001,0,0.01,9.8\n", odometry.start().nanoseconds() + i * 5'000'000);
    folder_.write(recording + "imu0/data.csv", imu);
    folder_.write(recording + "imu0/sensor.yaml",
                  "sensor_type: imu\nT_BS: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]\nrate_hz: 200\n"
                  "gyroscope_noise_density: 1e-4\ngyroscope_random_walk: 1e-5\n"
                  "accelerometer_noise_density: 1e-3\naccelerometer_random_walk: 1e-4\n");
    folder_.write(recording + "sonar0/data.csv", echoes);
    folder_.write(recording + "sonar0/sensor.yaml",
                  "sensor_type: sonar\nT_BS: [0,0,1,0, 1,0,0,0, 0,1,0,0, 0,0,0,1]\nrate_hz: 20\n"
                  "range_noise_std: 0.05\n");
  }

  Execution survey(const std::string& dives) const {
    const auto project = folder_.write("cave.yaml", "map: cave.db\ndives:\n" + dives);
    return runProgram("survey " + test::quoted(project) + " -o " + test::quoted(folder_.path() / "out"));
  }

  /// Distances left, right, up and down of the stations of a dive in NAME_stations.csv; nan where unknown.
  std::vector<std::array<double, 4>> sizes(const std::string& dive) const {
    std::vector<std::array<double, 4>> sizes;
    std::istringstream stream(test::readText(folder_.path() / "out/cave_stations.csv"));
    for (std::string line; std::getline(stream, line);) {
      if (line.rfind(dive + ",", 0) != 0) continue;
      std::vector<std::string> fields;
      std::istringstream row(line);
      for (std::string field; std::getline(row, field, ',');) fields.push_back(field);
      sizes.emplace_back();
      for (size_t i = 0; i < 4; ++i)
        sizes.back()[i] = fields[15 + i].empty() ? std::nan("") : std::stod(fields[15 + i]);
    }
    return sizes;
  }

  test::TemporaryFolder folder_;
  test::CaveMap cave_;
};

TEST_F(SurveySonarTest, MeasuresThePassagesOfTheDiveThatHasIt) {
  writeDive("loop");
  const Execution result =
      survey("  - {run: loop, recording: loop_recording}\n  - {dive: upstream}\n  - {dive: sink}\n");
  ASSERT_EQ(result.exit_code, 0) << result.output;
  const auto measured = sizes("loop");
  ASSERT_GE(measured.size(), 10u);
  std::vector<double> errors_m;
  size_t known = 0;
  for (const std::array<double, 4>& size : measured) {
    for (const double distance_m : size) {
      if (std::isnan(distance_m)) continue;
      ++known;
      errors_m.push_back(std::abs(distance_m - kRadius_m));
    }
  }
  std::sort(errors_m.begin(), errors_m.end());
  ASSERT_GE(known, 3 * measured.size());
  EXPECT_LT(errors_m[errors_m.size() / 2], 0.1);
  EXPECT_LT(errors_m[errors_m.size() * 9 / 10], 0.4) << "at bends the passage is no tube";
  const std::string svx = test::readText(folder_.path() / "out/cave.svx");
  EXPECT_THAT(svx, HasSubstr("*flags splay"));
  for (const std::array<double, 4>& size : sizes("sink")) EXPECT_TRUE(std::isnan(size[0]) || size[0] > 0.0);
}

TEST_F(SurveySonarTest, NamesWhatIsMissing) {
  const auto expectError = [&](const std::string& dives, const char* says) {
    const Execution result = survey(dives);
    EXPECT_EQ(result.exit_code, 1) << dives << result.output;
    EXPECT_THAT(result.output, HasSubstr(says)) << dives;
  };
  writeDive("loop");
  expectError("  - {dive: loop, recording: loop_recording}\n", "wants its 'run'");
  expectError("  - {run: loop, recording: nowhere}\n", "nowhere");
  std::filesystem::remove_all(folder_.path() / "loop_recording/mav0/sonar0");
  expectError("  - {run: loop, recording: loop_recording}\n", "has no sonar");
}

}  // namespace
}  // namespace lodeline
