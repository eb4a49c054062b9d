#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lodeline/mapping/control/control_factor.h"

namespace lodeline {

/// 99.9 % quantile of chi squared with 3 degrees of freedom.
constexpr double kControlQuantile = 16.266;

/// What a solution makes of one observation of a control point.
struct ControlPointResidual {
  std::string name;
  ControlKind kind = ControlKind::Station;
  KeyframeId keyframe = -1;
  Vec3 error_m = Vec3::Zero();  ///< solved minus stated position of the point, in map axes
  Vec3 sigma_m = Vec3::Zero();  ///< one sigma of that by statement, observation and pose
  double chi_squared = 0.0;     ///< 3 degrees of freedom
  bool is_blunder = false;      ///< beyond kControlQuantile
  /// Where the position is unknown: the keyframe whose observation replaces it.
  std::optional<KeyframeId> reference_keyframe;
};

/// Pose of a keyframe in a solution; nothing for a keyframe that has none.
using SolvedPoses = std::function<std::optional<SolvedPose>(KeyframeId)>;

/// Residuals of all observations of control points, after a solution with robust kernels: a kernel keeps a
/// blunder from bending the solution, so that the blunder shows here. Order as in `factors`; keyframes
/// without a pose are left out.
///
/// The point of an observation is p = t + R q with the pose (R, t) and the position q in the body. Its
/// covariance is J P J^T + R Q R^T with J = [I, -[R q]x]; that of a stated position is added. Where the
/// position is unknown, the observation that agrees best with all others replaces it.
std::vector<ControlPointResidual> controlResiduals(std::span<const ControlFactor> factors,
                                                   const SolvedPoses& poses);

/// One sentence for each blunder.
std::vector<std::string> blunderTexts(std::span<const ControlPointResidual> residuals);

/// A table of all residuals with a line for each.
std::string residualTable(std::span<const ControlPointResidual> residuals);

}  // namespace lodeline
