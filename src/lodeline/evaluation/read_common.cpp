#include <fmt/format.h>

#include <cmath>

#include "lodeline/base/error.h"
#include "lodeline/evaluation/read_formats.h"

namespace lodeline {
namespace {

// Published references round quaternions to four digits; a wrong column order is off by far more than this.
constexpr double kQuaternionNormTolerance = 0.05;

}  // namespace

void requireColumns(TextTable& table, std::size_t columns, const char* layout, Diagnostics& diagnostics) {
  for (std::size_t i = 0; i < table.lines.size(); ++i) {
    const TextLine& line = table.lines[i];
    if (line.fields.size() >= columns) continue;
    const std::string found = fmt::format("{}: {} columns, a {} line needs {}", table.where(line),
                                          line.fields.size(), layout, columns);
    const bool cut_off = i + 1 == table.lines.size() && i > 0 && !table.ends_with_newline;
    if (!cut_off) throw InputError(found);
    diagnostics.report(Severity::Warning, "truncated_line", found + "; the line was cut off and is left out");
    table.lines.pop_back();
    return;
  }
}

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
