#pragma once

#include <memory>
#include <vector>

#include "lodeline/cameras/camera.h"
#include "lodeline/estimator/estimator.h"
#include "lodeline/frontend/tracking/tracks.h"
#include "lodeline/mapping/keyframe/map_keyframe.h"

namespace lodeline {

/// Position of a tracked point at the time of one frame.
struct TrackPoint {
  TrackId track = -1;
  Vec3 point_B = Vec3::Zero();    ///< m
  double distance_sigma_m = 0.0;  ///< along the ray of camera 0
};

/// Calibration in effect at one frame, and positions of the points that it observes.
struct FrameGeometry {
  std::vector<std::shared_ptr<const Camera>> cameras;
  std::vector<Rigid3> body_from_cameras;
  CameraStates states;             ///< estimated intrinsics; empty where those of the files hold
  std::vector<TrackPoint> points;  ///< by rising track

  /// Ray of a pixel; empty where the camera model does not reach it.
  std::optional<BodyRay> rayOf(int camera, const Vec2& pixel, double sigma_px) const;
  /// Null where the track has no position.
  const TrackPoint* find(TrackId track) const;
};

/// Geometry of the estimator's newest frame. Points come from the window's landmarks, and from the rays of
/// several cameras where a track has no landmark yet. The result refers to the window: it holds until the
/// estimator receives another frame.
FrameGeometry frameGeometry(const Estimator& estimator,
                            const std::vector<std::shared_ptr<const Camera>>& cameras,
                            const FrameTracks& tracks);

/// Point of a track at the crossing of its rays; empty where their angle is too small. `rays`: two or more.
std::optional<TrackPoint> pointOfRays(TrackId track, const std::vector<BodyRay>& rays);

}  // namespace lodeline
