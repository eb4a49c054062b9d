#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "lodeline/inspection/inspection_report.h"
#include "lodeline/recording.h"

// The inspection of a folder of a robot without cameras.

namespace lodeline {
namespace {

using ::testing::HasSubstr;

class RobotInspectionTest : public testing::Test {
 protected:
  RobotInspectionTest() : folder_(std::filesystem::path(testing::TempDir()) / "lodeline_robot_inspection") {
    std::filesystem::remove_all(folder_);
  }
  ~RobotInspectionTest() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& sensor, const std::string& calibration, const std::string& table) {
    const std::filesystem::path place = folder_ / "mav0" / sensor;
    std::filesystem::create_directories(place);
    std::ofstream(place / "sensor.yaml") << calibration;
    std::ofstream(place / "data.csv") << table;
  }

  /// Twenty seconds of a vehicle that swims to and fro along x. `sign`: of the DVL's x axis.
  void writeRobot(double sign, const char* dvl_pose) {
    std::string imu = "#timestamp [ns],w_x,w_y,w_z,a_x,a_y,a_z\n", altimeter = "#timestamp [ns],range [m]\n";
    std::string dvl = "#timestamp [ns],v_x,v_y,v_z [m/s],valid\n",
                currents = "#timestamp [ns],thruster [A],lamp [A]\n";
    for (int i = 0; i < 4000; ++i) {
      const double t = 0.005 * i;
      const int64_t stamp_ns = 1'000'000'000'000 + 5'000'000 * int64_t{i};
      imu +=
          fmt::format("{},0,0,{},{},0,9.80665\n", stamp_ns, 0.001 * (i % 2), 0.9 * 0.5 * std::cos(0.9 * t));
      if (i % 40 != 0) continue;
      const bool has_lock = i % 400 != 0;
      dvl += fmt::format("{},{},0.01,0,{:d}\n", stamp_ns, has_lock ? sign * 0.5 * std::sin(0.9 * t) : 0.0,
                         has_lock);
      altimeter += fmt::format("{},{}\n", stamp_ns, 3.0 + 0.001 * i);
      currents += fmt::format("{},{},1.5\n", stamp_ns, 0.005 * i);
    }
    write("imu0",
          "gyroscope_noise_density: 1e-4\ngyroscope_random_walk: 1e-5\naccelerometer_noise_density: 1e-3\n"
          "accelerometer_random_walk: 1e-4\n",
          imu);
    write("dvl0", fmt::format("T_BS: {}\nvelocity_noise_std: 0.01\n", dvl_pose), dvl);
    write("altimeter0", "T_BS: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]\nrange_noise_std: 0.05\n", altimeter);
    write("current0", "channels: [thruster, lamp]\n", currents);
  }

  Inspection look() const {
    EurocOptions options;
    options.with_cameras = false;
    return inspect([&](Diagnostics* diagnostics) { return openEuroc(folder_, options, diagnostics); }, {});
  }
  static bool has(const Inspection& inspection, const std::string& kind) {
    for (const InspectionFinding& finding : inspection.findings) {
      if (finding.kind == kind) return true;
    }
    return false;
  }

  std::filesystem::path folder_;
};

TEST_F(RobotInspectionTest, ListsTheThreeStreams) {
  writeRobot(1.0, "[1,0,0,0.1, 0,1,0,0, 0,0,1,0, 0,0,0,1]");
  const Inspection inspection = look();
  const std::string text = inspectionText(inspection);
  EXPECT_THAT(text, HasSubstr("dvl0"));
  EXPECT_THAT(text, HasSubstr("v_x -0.50 to 0.50 m/s"));
  EXPECT_THAT(text, HasSubstr("no lock in 10.0 % of the pings"));
  EXPECT_THAT(text, HasSubstr("with the IMU over"));
  EXPECT_THAT(text, HasSubstr("altimeter0"));
  EXPECT_THAT(text, HasSubstr("range 3.00 to 6.96 m"));
  EXPECT_THAT(text, HasSubstr("thruster 0.00 to 19.80 A"));
  EXPECT_THAT(text, HasSubstr("lamp 1.50 to 1.50 A"));
  EXPECT_FALSE(has(inspection, "dvl_axes")) << text;
  EXPECT_FALSE(has(inspection, "dvl_time_offset")) << text;
  const std::string json = inspectionJson(inspection).dump();
  EXPECT_THAT(json, HasSubstr("\"pings_without_lock\":10"));
}

TEST_F(RobotInspectionTest, FindsADvlWithTheWrongSignAndALongLeverArm) {
  writeRobot(-1.0, "[1,0,0,120, 0,1,0,0, 0,0,1,0, 0,0,0,1]");
  const Inspection inspection = look();
  EXPECT_TRUE(has(inspection, "dvl_axes")) << inspectionText(inspection);
  EXPECT_TRUE(has(inspection, "extrinsics_unit"));
}

}  // namespace
}  // namespace lodeline
