#pragma once

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "lodeline/trajectory.h"

/// Shared functions of the tests in this folder.
namespace lodeline::test {

/// A climbing curve with changing attitude, 10 Hz: it determines all directions and rotations.
inline Trajectory bend(int count, double start_s = 100.0) {
  Trajectory trajectory;
  trajectory.name = "bend";
  for (int i = 0; i < count; ++i) {
    const double s = 0.1 * i;
    const Quat rotation(Eigen::AngleAxisd(0.3 * s, Vec3(0.1, -0.2, 1.0).normalized()));
    const Vec3 position_m(3.0 * std::sin(0.4 * s), 2.0 * std::cos(0.7 * s), 0.2 * s + 0.3 * std::sin(s));
    trajectory.poses.push_back({Time::fromSeconds(start_s + s), Rigid3(rotation, position_m)});
  }
  return trajectory;
}

/// 1 m per step along x, identity attitude, one pose per second.
inline Trajectory straight(int count) {
  Trajectory trajectory;
  trajectory.name = "straight";
  for (int i = 0; i < count; ++i) {
    trajectory.poses.push_back({Time::fromSeconds(i), Rigid3(Quat::Identity(), Vec3(i, 0, 0))});
  }
  return trajectory;
}

/// scale * transform * trajectory.
inline Trajectory transformed(Trajectory trajectory, const Rigid3& transform, double scale = 1.0) {
  for (StampedPose& pose : trajectory.poses) {
    pose.world_from_body = transform * pose.world_from_body;
    pose.world_from_body.translation *= scale;
  }
  return trajectory;
}

/// An empty folder that is removed with its content by the destructor.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "lodeline-test-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

  std::filesystem::path write(const std::string& name, const std::string& content) const {
    const std::filesystem::path file = path_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << content;
    return file;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace lodeline::test
