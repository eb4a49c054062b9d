#pragma once

#include <cmath>
#include <numbers>

#include "lodeline/cli/test_room.h"
#include "lodeline/evaluation/read_trajectory.h"
#include "lodeline/geometry/so3.h"

namespace lodeline::test {

inline constexpr double kDegree = std::numbers::pi / 180.0;

/// Of the magnetic room, T: y of the truth's world is magnetic north.
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
    std::ofstream(recording_.sensor("mag0") / "sensor.yaml")
        << "sensor_type: magnetometer\nT_BS:\n  cols: 4\n  rows: 4\n  data: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, "
           "1, 0, "
           "0, 0, 0, 1]\nrate_hz: 20\nmagnetometer_noise_density: 1e-8\n";
    calibration_ = folder_.write("mag.yaml",
                                 "iron_correction: [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\n"
                                 "hard_iron_T: [0, 0, 0]\n");
    writeField(1.0);
  }

  /// The field at the true poses, the images' times.
  void writeField(double per_tesla) const {
    std::ofstream csv(recording_.csv("mag0"));
    csv << "#timestamp [ns],m_x [T],m_y [T],m_z [T]\n";
    int row = 0;
    for (const StampedPose& pose : readPoses(recording_.truth).poses) {
      // A little noise, so that no reading is the same as the one before.
      const Vec3 field =
          per_tesla * (pose.world_from_body.rotation.conjugate() * kField_W + Vec3::Constant(1e-11 * ++row));
      csv << fmt::format("{},{},{},{}\n", pose.time.nanoseconds(), field.x(), field.y(), field.z());
    }
  }

  Execution runCalibrated(const std::string& options = "") const {
    return run("--mag-calibration " + quoted(calibration_) + " " + options);
  }

  /// Yaw by which the last pose is off the truth, rad.
  double headingError() const {
    const Rigid3 estimate = readPoses(output_ / "trajectory.tum").poses.back().world_from_body;
    const Rigid3 truth = readPoses(recording_.truth).poses.back().world_from_body;
    return so3::log(estimate.rotation * truth.rotation.conjugate()).z();
  }

  std::filesystem::path calibration_;
};

}  // namespace lodeline::test
