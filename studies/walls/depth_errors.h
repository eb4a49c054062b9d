#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/output/walls/dive_depths.h"
#include "studies/walls/true_surface.h"

namespace lodeline {

/// One depth against the exact surface.
struct DepthError {
  double depth_m = 0.0;        ///< z in the view
  double sigma_m = 0.0;        ///< claimed, of z
  double along_m = 0.0;        ///< behind the surface, along the line of sight
  double incidence_rad = 0.0;  ///< between the line of sight and the normal of the surface
  Vec3 place = Vec3::Zero();   ///< of the surface, world of the truth

  double across_m() const { return along_m * std::cos(incidence_rad); }
};

/// Errors of the depths of keyframes. `world_from_view`: pose of a view by its time and its pose in the map,
/// or nothing. Takes every `step_px`-th pixel of a row and a column.
std::vector<DepthError> depthErrors(
    const DepthKeyframes& frames, const TrueSurface& truth, int step_px,
    const std::function<std::optional<Rigid3>(const DepthKeyframe&)>& world_from_view);

/// Tables of the errors by depth and by incidence, and how much of them neighbouring depths share: mean of
/// the depths of one place (cells of 10 cm) against the differences from it.
std::string depthErrorTables(const std::vector<DepthError>& errors);

}  // namespace lodeline
