#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "lodeline/base/error.h"
#include "lodeline/data/euroc_rig.h"

namespace lodeline {
namespace {

constexpr int kMostCameras = 16;

std::filesystem::path findMav0(const std::filesystem::path& data) {
  if (!std::filesystem::is_directory(data)) {
    throw InputError(fmt::format("{}: no such folder; give the folder that contains mav0", data.string()));
  }
  if (std::filesystem::is_directory(data / "mav0")) return data / "mav0";
  if (std::filesystem::is_directory(data / "cam0") || std::filesystem::is_directory(data / "imu0"))
    return data;
  throw InputError(
      fmt::format("{}: holds neither mav0 nor cam0 and imu0; give the folder of a recording in the EuRoC ASL "
                  "layout (mav0/cam0/data.csv, mav0/imu0/data.csv, …)",
                  data.string()));
}

}  // namespace

EurocLayout findEurocLayout(const std::filesystem::path& data, const std::vector<int>& camera_indices) {
  EurocLayout layout;
  layout.mav0 = findMav0(data);
  std::vector<int> present;
  for (int i = 0; i < kMostCameras; ++i) {
    if (std::filesystem::exists(layout.csv(fmt::format("cam{}", i)))) present.push_back(i);
  }
  layout.camera_indices = camera_indices.empty() ? present : camera_indices;
  for (const int index : layout.camera_indices) {
    if (std::find(present.begin(), present.end(), index) != present.end()) continue;
    throw InputError(fmt::format("{}: missing, but camera {} was asked for; the recording has cameras [{}]",
                                 layout.csv(fmt::format("cam{}", index)).string(), index,
                                 fmt::join(present, ", ")));
  }
  for (const char* name : {"cam0", "imu0"}) {
    const bool needed = std::string_view(name) == "imu0" || layout.camera_indices.empty();
    if (needed && !std::filesystem::exists(layout.csv(name))) {
      throw InputError(
          fmt::format("{}: missing; a recording needs a camera and an IMU", layout.csv(name).string()));
    }
  }
  return layout;
}

}  // namespace lodeline
