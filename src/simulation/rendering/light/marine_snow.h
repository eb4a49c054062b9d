#pragma once

#include <memory>
#include <opencv2/core.hpp>

#include "simulation/rendering/light/light_field.h"
#include "simulation/rendering/optics/camera_optics.h"
#include "simulation/rendering/optics/motion_blur.h"
#include "simulation/shared/track.h"

namespace lodeline {

/// Flakes drifting in the water.
struct SnowOptions {
  double flakes_per_m3 = 150.0;
  double median_radius_m = 0.00016;
  double reflectance = 0.2;
  double drift_speed_m_per_s = 0.04;
  double aperture_m = 0.003;  ///< aperture of the lens; determines the blur of flakes out of focus
  double focus_m = 1.5;
  std::shared_ptr<const DriftTrack> current = nullptr;  ///< carries the flakes instead of the drift
};

/// Adds the light of all visible flakes to a radiance image (CV_32F). The flakes fill space without limit and
/// reproducibly: each cell of a drifting grid draws its own from a hash. Flakes behind the surface at
/// `range_m` are hidden; flakes near the lens are wide, faint discs. With a rolling shutter, a flake appears
/// where it is when its row is exposed: `row_poses` has the pose of the body for each row, otherwise nothing.
void addMarineSnow(cv::Mat& radiance, const cv::Mat& range_m, const CameraOptics& optics,
                   const Rigid3& world_from_body, const ExposureMotion& motion, const LightField& light,
                   const SnowOptions& options, double time_s, uint64_t seed,
                   const std::vector<Rigid3>& row_poses = {});

}  // namespace lodeline
