#include "lodeline/output/survey/formats/recording_images.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "lodeline/cameras/port_camera.h"
#include "lodeline/factors/calibrated_reprojection_factor.h"
#include "lodeline/factors/intrinsics_factor.h"
#include "lodeline/io/images/image_loader.h"

namespace lodeline {
namespace {

/// Index of the pose nearest to a time, if it is close enough.
std::optional<size_t> poseNear(const Trajectory& trajectory, Time time) {
  constexpr double kTolerance_s = 5e-3;
  const std::vector<StampedPose>& poses = trajectory.poses;
  auto nearest = std::lower_bound(poses.begin(), poses.end(), time,
                                  [](const StampedPose& pose, Time t) { return pose.time < t; });
  if (nearest == poses.end() ||
      (nearest != poses.begin() && time - (nearest - 1)->time < nearest->time - time)) {
    --nearest;
  }
  if (std::abs((nearest->time - time).seconds()) > kTolerance_s) return std::nullopt;
  return static_cast<size_t>(nearest - poses.begin());
}

/// Corrections of camera 0 are in body axes, those of secondary cameras in camera 0's.
void correct(const std::vector<Eigen::Matrix<double, 6, 1>>& corrections,
             std::vector<CameraCalibration>* cameras) {
  if (corrections.empty() || corrections.size() != cameras->size()) return;
  const Rigid3 nominal0 = cameras->front().body_from_camera;
  const Rigid3 corrected0 = correctedExtrinsics(nominal0, corrections[0].data());
  for (size_t i = 0; i < cameras->size(); ++i) {
    CameraCalibration& camera = (*cameras)[i];
    if (i == 0) {
      camera.body_from_camera = corrected0;
    } else {
      const Rigid3 camera0_from_camera = nominal0.inverse() * camera.body_from_camera;
      camera.body_from_camera = corrected0 * correctedExtrinsics(camera0_from_camera, corrections[i].data());
    }
  }
}

/// The last three parts of a file's path: cam0/data/STAMP.png. An image of a bag has the name that
/// `lodeline convert` gives it.
std::string shortName(const PendingImage& image, const std::string& camera) {
  const std::filesystem::path file = image.name;
  if (std::filesystem::exists(file)) {
    const std::filesystem::path data = file.parent_path();
    return (data.parent_path().filename() / data.filename() / file.filename()).generic_string();
  }
  const StoredImage stored = image.stored ? image.stored() : StoredImage();
  const bool is_png = stored.file.empty() || isPng(stored.file);
  return fmt::format("{}/data/{}.{}", camera, image.time.nanoseconds(), is_png ? "png" : "jpg");
}

}  // namespace

std::vector<CameraCalibration> camerasOfRun(const Rig& rig, const RunFolder& run) {
  std::vector<CameraCalibration> cameras = rig.cameras;
  correct(run.camera_corrections, &cameras);
  if (run.intrinsics_corrections.size() != cameras.size()) return cameras;
  for (size_t i = 0; i < cameras.size(); ++i) {
    std::optional<Port>& port = cameras[i].port;
    if (port && i < run.port_corrections.size()) port = correctedPort(*port, run.port_corrections[i].change);
    cameras[i] = correctedIntrinsics(cameras[i], run.intrinsics_corrections[i].data());
  }
  return cameras;
}

MapImages recordingImages(MeasurementSource& source, const RunFolder& run, Diagnostics* diagnostics) {
  MapImages result;
  result.cameras = source.rig().cameras;
  for (size_t camera = 0; camera < result.cameras.size(); ++camera) {
    const Duration offset = Duration::fromSeconds(result.cameras[camera].time_offset_to_imu_s);
    while (const std::optional<PendingImage> image = source.nextImage(camera)) {
      const std::optional<size_t> pose = poseNear(run.trajectory, image->time + offset);
      if (pose) result.images.push_back({camera, *pose, shortName(*image, result.cameras[camera].name)});
    }
  }
  result.cameras = camerasOfRun(source.rig(), run);
  if (result.images.empty()) {
    diagnostics->report(Severity::Warning, "no_image_with_pose",
                        "no image of the recording lies within 5 ms of a pose: is it the run's recording?");
  }
  return result;
}

}  // namespace lodeline
