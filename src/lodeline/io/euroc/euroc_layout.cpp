#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "lodeline/diagnostics.h"
#include "lodeline/io/euroc/euroc_rig.h"
#include "lodeline/io/euroc/image_list.h"
#include "lodeline/util/files/file_kind.h"

namespace lodeline {
namespace {

constexpr int kMostCameras = 16;

std::filesystem::path findMav0(const std::filesystem::path& data) {
  if (std::filesystem::is_directory(data / "mav0")) return data / "mav0";
  for (const char* sensor : {"cam0", "imu0", "mag0"}) {
    if (std::filesystem::is_directory(data / sensor)) return data;
  }
  const RecognizedFile recognized = recognizeFile(data);
  if (!recognized.isFolder() || !recognized.advice.empty()) {
    refuseFile(recognized, "give the folder that contains mav0, or a ROS 1 bag");
  }
  throw InputError(
      fmt::format("{}: is {}; it holds neither mav0 nor sensors (cam0, imu0, mag0). Give the folder of a "
                  "recording in the EuRoC ASL layout (mav0/cam0/data.csv, mav0/imu0/data.csv, …)",
                  data.string(), recognized.what));
}

/// Reason why a folder camN has no images; nothing where it has some or does not exist.
std::string whyNoImages(const std::filesystem::path& camera) {
  if (!std::filesystem::is_directory(camera)) return {};
  try {
    Diagnostics reported_when_read_in_earnest;
    if (ImageList::hasImages(camera)) {
      const ImageList readable(camera, &reported_when_read_in_earnest);
      return {};
    }
  } catch (const InputError& error) {
    return error.what();
  }
  return fmt::format("{}: missing, and there are no images in {}", (camera / "data.csv").string(),
                     (camera / "data").string());
}

std::vector<int> findCameras(const EurocOptions& options, EurocLayout* found) {
  EurocLayout& layout = *found;
  std::vector<int> present;
  for (int i = 0; i < kMostCameras; ++i) {
    const std::filesystem::path camera = layout.sensor(fmt::format("cam{}", i));
    if (!std::filesystem::is_directory(camera)) continue;
    std::string problem = whyNoImages(camera);
    if (problem.empty()) {
      present.push_back(i);
    } else {
      layout.cameras_without_images[i] = std::move(problem);
    }
  }
  for (const int index : options.camera_indices) {
    if (std::find(present.begin(), present.end(), index) != present.end()) continue;
    const auto broken = layout.cameras_without_images.find(index);
    throw InputError(fmt::format("{}, but camera {} was asked for; the recording has cameras [{}]",
                                 broken != layout.cameras_without_images.end()
                                     ? broken->second
                                     : layout.csv(fmt::format("cam{}", index)).string() + ": missing",
                                 index, fmt::join(present, ", ")));
  }
  if (present.empty() && options.needs_cameras) {
    if (!layout.cameras_without_images.empty()) {
      throw InputError(layout.cameras_without_images.begin()->second +
                       "; a trajectory cannot be estimated without images");
    }
    throw InputError(
        fmt::format("{}: missing, and so is every other camera; a trajectory cannot be estimated "
                    "without images",
                    layout.csv("cam0").string()));
  }
  return options.camera_indices.empty() ? present : options.camera_indices;
}

}  // namespace

EurocLayout findEurocLayout(const std::filesystem::path& data, const EurocOptions& options) {
  EurocLayout layout;
  layout.mav0 = findMav0(data);
  if (options.with_cameras) layout.camera_indices = findCameras(options, &layout);
  layout.needs_cameras = options.needs_cameras;
  layout.needs_calibration = options.needs_calibration;
  layout.rig_files = options.rig_files;
  layout.has_imu = std::filesystem::exists(layout.csv("imu0"));
  if (options.needs_imu && !layout.has_imu) {
    throw InputError(fmt::format("{}: missing; inertial readings are needed", layout.csv("imu0").string()));
  }
  if (layout.camera_indices.empty() && !layout.has_imu && !std::filesystem::exists(layout.csv("mag0"))) {
    throw InputError(fmt::format("{}: holds neither imu0/data.csv nor mag0/data.csv", layout.mav0.string()));
  }
  return layout;
}

}  // namespace lodeline
