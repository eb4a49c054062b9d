#include "lodeline/mapping/recognition/test_described_frames.h"

#include <cmath>

namespace lodeline {

MapKeyframe keyframeOfImages(const Rig& rig, const std::vector<cv::Mat>& images,
                             const Rigid3& world_from_body, double tilt_sigma_rad) {
  FrontEnd front_end(rig, {});
  const FrameTracks tracks = front_end.process(Time::fromSeconds(1.0), images, Quat::Identity());
  const KeyframeDescriber describer(rig);
  FrameGeometry geometry;
  geometry.cameras = describer.cameras();
  for (const CameraCalibration& camera : rig.cameras)
    geometry.body_from_cameras.push_back(camera.body_from_camera);
  const auto& seen = tracks.observations;
  for (size_t i = 0; i + 1 < seen.size(); ++i) {
    if (seen[i].camera != 0 || seen[i + 1].track != seen[i].track) continue;
    const auto first = geometry.rayOf(0, seen[i].pixel, seen[i].sigma_px);
    const auto second = geometry.rayOf(1, seen[i + 1].pixel, seen[i + 1].sigma_px);
    if (!first || !second) continue;
    if (const auto point = pointOfRays(seen[i].track, {*first, *second})) geometry.points.push_back(*point);
  }
  FrameEstimate estimate;
  estimate.time = tracks.time;
  estimate.state.world_from_body = world_from_body;
  estimate.covariance.diagonal().segment<2>(3).setConstant(tilt_sigma_rad * tilt_sigma_rad);
  return describer.describe(images, tracks, estimate, geometry);
}

}  // namespace lodeline
