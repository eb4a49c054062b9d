#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "lodeline/output/walls/section/cross_section.h"
#include "lodeline/simulation.h"
#include "lodeline/trajectory.h"
#include "simulation/dive/dive.h"
#include "simulation/rendering/image_renderer.h"

namespace lodeline {

/// Where a line of sight meets the surface.
struct SurfaceHit {
  double range_m = 0.0;
  double incidence_rad = 0.0;  ///< between the line of sight and the normal, 0 to pi/2
};

/// The exact walls of a simulated dive, in its world.
class TrueSurface {
 public:
  explicit TrueSurface(const Scenario& scenario);

  /// Distances of at most `most` of the points, evenly chosen, from the surface: the shortest of 642 rays.
  std::vector<double> distances_m(const std::vector<Vec3>& points, size_t most) const;
  /// Signed distances of at most `most` of the points behind the surface, seen from the nearest pose, m.
  std::vector<double> behind_m(const std::vector<Vec3>& points, const Trajectory& true_poses,
                               size_t most) const;
  /// Meeting of a line of sight, and the slope of the surface there by rays 0.4 mrad beside it.
  std::optional<SurfaceHit> hit(const Vec3& eye, const Vec3& direction) const;
  /// Points that camera 0 sees within `reach_m` from any pose, one in each cell of 4 cm.
  std::vector<Vec3> visible(const Trajectory& true_poses, double reach_m) const;
  /// The poses outside the silt-outs of the dive, which hide all walls.
  Trajectory withoutSilt(const Trajectory& true_poses) const;
  /// Areas of the sectors about a station that are seen from it in its plane. `plane`: in the frame of a map.
  std::vector<double> sectorAreas_m2(const Rigid3& truth_from_map, const SectionPlane& plane,
                                     size_t sectors) const;

 private:
  Dive dive_;
  std::shared_ptr<const RenderWorld> world_;
  std::unique_ptr<ImageRenderer> renderer_;
};

/// Distances of the `places` from the nearest of the points.
std::vector<double> nearest_m(const std::vector<Vec3>& points, const std::vector<Vec3>& places);

}  // namespace lodeline
