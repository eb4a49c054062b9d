#include "lodeline/diagnostics.h"
#include "lodeline/output/files/world_turn.h"
#include "lodeline/survey.h"

namespace lodeline {

RunFolder runOf(const std::string& name, const std::vector<FrameEstimate>& estimates,
                const std::vector<MapPoint>& landmarks) {
  RunFolder run;
  run.folder = name;
  run.trajectory.name = run.trajectory_file = name;
  const FrameEstimate* last = nullptr;
  for (const FrameEstimate& estimate : estimates)
    last = estimate.status == Status::Waiting ? last : &estimate;
  if (last == nullptr) throw InputError(name + ": no estimate has a pose");
  const auto& magnetometer = last->sensors.of<MagnetometerEstimate>();
  const WorldTurn turn = WorldTurn::of(magnetometer).value_or(WorldTurn{});
  for (const FrameEstimate& estimate : estimates) {
    if (estimate.status == Status::Waiting) continue;
    const Rigid3 pose = turn.apply(estimate.state.world_from_body);
    const Mat6 covariance =
        turn.applyToCovariance(estimate.covariance.topLeftCorner<6, 6>(), estimate.time, pose.translation);
    run.trajectory.poses.push_back({estimate.time, pose});
    run.uncertainties.push_back({estimate.time, covariance.topLeftCorner<3, 3>()});
  }
  for (const MapPoint& point : landmarks) {
    run.landmarks.push_back({turn.apply(point.position_W), point.observations});
  }
  run.heading_reference = magnetometer.heading_reference;
  if (magnetometer.heading_reference != HeadingReference::Start) {
    run.heading_sigma_rad = magnetometer.heading_sigma_rad;
  }
  const auto& gauge = last->sensors.of<DepthEstimate>().gauge;
  if (gauge) run.depth_at_origin_m = gauge->depth_at_origin_m / gauge->density_ratio;
  if (last->camera_corrections) {
    run.camera_corrections = last->camera_corrections->extrinsics;
    run.intrinsics_corrections = last->camera_corrections->intrinsics;
    run.port_corrections = last->camera_corrections->ports;
  }
  return run;
}

}  // namespace lodeline
