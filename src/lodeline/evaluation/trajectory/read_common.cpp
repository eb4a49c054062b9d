#include <fmt/format.h>

#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/read_formats.h"

namespace lodeline {
namespace {

// Published references round quaternions to four digits; a wrong column order exceeds this tolerance by far.
constexpr double kQuaternionNormTolerance = 0.05;

}  // namespace

std::optional<Rigid3> poseFromNumbers(const std::string& where, const Vec3& position_m, const Quat& rotation,
                                      Diagnostics& diagnostics) {
  if (!position_m.allFinite() || !rotation.coeffs().allFinite()) {
    diagnostics.report(Severity::Warning, "pose_not_finite",
                       where + ": a pose with NaN or infinity is left out");
    return std::nullopt;
  }
  const double norm = rotation.norm();
  if (std::abs(norm - 1.0) > kQuaternionNormTolerance) {
    throw InputError(
        fmt::format("{}: the quaternion has norm {:.4g}, expected 1; check the column order (TUM is "
                    "x y z w, EuRoC and COLMAP are w x y z) or name the layout with --format",
                    where, norm));
  }
  return Rigid3(rotation.normalized(), position_m);
}

}  // namespace lodeline
