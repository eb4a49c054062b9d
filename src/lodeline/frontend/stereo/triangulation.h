#pragma once

#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// One observation of a point from a known pose.
struct BearingView {
  Rigid3 world_from_camera;
  Vec3 bearing_C = Vec3::UnitZ();  ///< unit ray
  double sigma_rad = 1e-3;         ///< standard deviation of the ray's direction along each axis
};

struct TriangulationOptions {
  /// Smallest angle between two of the rays, rad; with a smaller one, the point counts as infinitely far.
  double min_parallax_rad = 0.01;
  /// Largest root-mean-square residual, in standard deviations.
  double max_rms_sigmas = 3.0;
};

enum class TriangulationStatus {
  Good,
  TooFewViews,  ///< fewer than two
  LowParallax,  ///< the rays are nearly parallel: point and covariance are valid, but the depth is inaccurate
  BehindCamera,  ///< not in front of all views
  Inconsistent,  ///< the rays do not intersect within their accuracy
};

struct Triangulation {
  TriangulationStatus status = TriangulationStatus::TooFewViews;
  /// Valid where `inverse_depth_per_m` is positive.
  Vec3 point_W = Vec3::Zero();
  /// 1 / distance from the first view; 0 for a point at infinity.
  double inverse_depth_per_m = 0.0;
  double inverse_depth_sigma_per_m = 0.0;
  double max_parallax_rad = 0.0;
  double rms_sigmas = 0.0;  ///< residual after the fit

  bool good() const { return status == TriangulationStatus::Good; }
};

/// Point with the smallest residuals to several rays, by Gauss-Newton on direction and inverse distance in
/// the first view (J. Civera et al., "Inverse depth parametrization for monocular SLAM", TRO 2008). This
/// parametrization is well conditioned up to infinity. Residuals are the components of the unit rays'
/// difference perpendicular to the measured ray.
Triangulation triangulate(const std::vector<BearingView>& views, const TriangulationOptions& options = {});

const char* toString(TriangulationStatus status);

}  // namespace lodeline
