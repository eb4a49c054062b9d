#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "apps/lodeline/tests/test_room.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/trajectory.h"
#include "lodeline/util/angles.h"

namespace lodeline::test {

/// Field of the magnetic room, T: y of the true world is magnetic north.
inline const Vec3 kField_W(0.0, 24e-6, -38e-6);

inline Trajectory readPoses(const std::filesystem::path& file) {
  Diagnostics diagnostics;
  return readTrajectory(file, {}, diagnostics);
}

/// The room recording with a magnetometer in a uniform field, and its calibration.
class MagneticRoomTest : public RoomTest {
 protected:
  MagneticRoomTest() {
    std::filesystem::create_directories(recording_.sensor("mag0"));
    calibration_ = folder_.write("mag.yaml",
                                 "iron_correction: [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n"
                                 "hard_iron_T: [0, 0, 0]\n");
    writeField(1.0);
  }

  /// Replaces the true field in body axes, T, by the sensor's output; with the number of the reading.
  using Spoil = std::function<Vec3(int reading, const Vec3& field_B)>;

  /// Writes the field at the true poses, from the first image to the last.
  void writeField(double per_tesla) const {
    writeReadings([per_tesla](int, const Vec3& field_B) { return Vec3(per_tesla * field_B); });
  }
  void writeReadings(const Spoil& spoil, double rate_hz = 20.0, Duration late = Duration()) const {
    std::ofstream(recording_.sensor("mag0") / "sensor.yaml") << fmt::format(
        "sensor_type: magnetometer\nT_BS:\n  cols: 4\n  rows: 4\n"
        "  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\nrate_hz: {}\n"
        "magnetometer_noise_density: 1e-8\n",
        rate_hz);
    std::ofstream csv(recording_.csv("mag0"));
    csv << "#timestamp [ns],m_x [T],m_y [T],m_z [T]\n";
    const std::vector<StampedPose> poses = readPoses(recording_.truth).poses;
    size_t after = 1;
    for (int reading = 0;; ++reading) {
      const Time time = poses.front().time + Duration::fromSeconds(reading / rate_hz);
      if (time > poses.back().time) break;
      while (poses[after].time < time) ++after;
      const StampedPose &from = poses[after - 1], &to = poses[after];
      const double share = (time - from.time).seconds() / (to.time - from.time).seconds();
      const Quat rotation = from.world_from_body.rotation.slerp(share, to.world_from_body.rotation);
      // A little noise, so that no two readings are equal.
      const Vec3 noise = Vec3::Constant(1e-11 * (1 + reading % 9));
      const Vec3 field = spoil(reading, rotation.conjugate() * kField_W + noise);
      csv << fmt::format("{},{},{},{}\n", (time + late).nanoseconds(), field.x(), field.y(), field.z());
    }
  }

  Execution runCalibrated(const std::string& options = "") const {
    return run("--mag-calibration " + quoted(calibration_) + " " + options);
  }

  /// Yaw error of the last pose, rad.
  double headingError() const {
    const Rigid3 estimate = readPoses(output_ / "trajectory.tum").poses.back().world_from_body;
    const Rigid3 truth = readPoses(recording_.truth).poses.back().world_from_body;
    return so3::log(estimate.rotation * truth.rotation.conjugate()).z();
  }

  std::filesystem::path calibration_;
};

}  // namespace lodeline::test
