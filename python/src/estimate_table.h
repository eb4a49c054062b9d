#pragma once

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "lodeline/estimate.h"
#include "lodeline/output/files/world_turn.h"
#include "lodeline/trajectory.h"

namespace lodeline::python {

/// Estimates of all frames with a pose, and the landmarks, as the files of a run have them.
struct EstimateTable {
  struct Row {
    NavigationState state;
    Mat6 pose_covariance;  ///< of [dp, dtheta], world axes
    Vec3 velocity_sigma;   ///< m/s
    Status status;
    MagnetometerStatus magnetometer;
    bool is_keyframe;
    int tracks, landmarks;
    double reprojection_rms_sigmas;
    double heading_sigma_rad;
    double depth_m;  ///< of the body; nan without a pressure sensor
  };
  std::vector<Row> rows;
  std::vector<MapPoint> landmarks;
  MagnetometerEstimate last_magnetometer;

  void add(const FrameEstimate& estimate) {
    last_magnetometer = estimate.sensors.of<MagnetometerEstimate>();
    if (estimate.status == Status::Waiting) return;
    const auto& gauge = estimate.sensors.of<DepthEstimate>().gauge;
    rows.push_back({estimate.state, estimate.covariance.topLeftCorner<6, 6>(),
                    estimate.covariance.diagonal().segment<3>(6).cwiseMax(0.0).cwiseSqrt(), estimate.status,
                    last_magnetometer.status, estimate.is_keyframe, estimate.tracks, estimate.landmarks,
                    estimate.reprojection_rms_sigmas, last_magnetometer.heading_sigma_rad,
                    gauge ? gauge->body_depth_m : std::numeric_limits<double>::quiet_NaN()});
  }
  void add(const std::vector<MapPoint>& points) {
    landmarks.insert(landmarks.end(), points.begin(), points.end());
  }

  /// The same table in a world that turns to a north that was found after the first pose (WorldTurn).
  /// The files of a finished run have this world.
  EstimateTable turnedToNorth() const {
    const std::optional<WorldTurn> turn = WorldTurn::of(last_magnetometer);
    EstimateTable turned = *this;
    if (!turn) return turned;
    for (Row& row : turned.rows) {
      const double missing = turn->missingVariance_rad2(row.state.time);
      row.state.world_from_body = turn->apply(row.state.world_from_body);
      row.state.velocity_W = turn->apply(row.state.velocity_W);
      row.pose_covariance =
          turn->applyToCovariance(row.pose_covariance, row.state.time, row.state.world_from_body.translation);
      row.heading_sigma_rad = std::sqrt(row.heading_sigma_rad * row.heading_sigma_rad + missing);
    }
    for (MapPoint& point : turned.landmarks) point.position_W = turn->apply(point.position_W);
    return turned;
  }

  Trajectory trajectory(const std::string& name) const {
    Trajectory trajectory;
    trajectory.name = name;
    for (const Row& row : rows) trajectory.poses.push_back({row.state.time, row.state.world_from_body});
    return trajectory;
  }
};

}  // namespace lodeline::python
