#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/output/files/world_turn.h"
#include "lodeline/survey.h"

namespace lodeline {
namespace {

/// Covariance of a position (m^2) in the turned world, with the sigma of the turn where it is not contained.
Mat3 turnedCovariance(const FrameEstimate& estimate, const WorldTurn& turn) {
  Mat3 rotation;
  for (int i = 0; i < 3; ++i) rotation.col(i) = turn.apply(Vec3::Unit(i));
  const Mat3 covariance = rotation * estimate.covariance.topLeftCorner<3, 3>() * rotation.transpose();
  if (turn.north_found && estimate.time >= *turn.north_found) return covariance;
  const Vec3 by_turn = Vec3::UnitZ().cross(turn.apply(estimate.state.world_from_body.translation));
  return covariance + turn.sigma_rad * turn.sigma_rad * by_turn * by_turn.transpose();
}

}  // namespace

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
  const Rigid3 turned_from_world(Quat(Eigen::AngleAxisd(turn.angle_rad, Vec3::UnitZ())), Vec3::Zero());
  for (const FrameEstimate& estimate : estimates) {
    if (estimate.status == Status::Waiting) continue;
    run.trajectory.poses.push_back({estimate.time, turned_from_world * estimate.state.world_from_body});
    run.uncertainties.push_back({estimate.time, turnedCovariance(estimate, turn)});
  }
  for (const MapPoint& point : landmarks) {
    run.landmarks.push_back({turn.apply(point.position_W), point.observations});
  }
  run.heading_reference = magnetometer.heading_reference;
  if (magnetometer.heading_reference != HeadingReference::Start) {
    run.heading_sigma_rad = magnetometer.heading_sigma_rad;
  }
  const auto& gauge = last->sensors.of<DepthEstimate>().gauge;
  if (gauge) run.depth_at_origin_m = gauge->depth_at_origin_m;
  if (last->camera_corrections) {
    run.camera_corrections = last->camera_corrections->extrinsics;
    run.intrinsics_corrections = last->camera_corrections->intrinsics;
  }
  return run;
}

}  // namespace lodeline
