#include <fmt/format.h>

#include "lodeline/base/error.h"
#include "lodeline/evaluation/read_formats.h"

namespace lodeline {

Trajectory readKitti(const std::filesystem::path& path, Diagnostics& diagnostics) {
  TextTable table = readTextTable(path);
  requireColumns(table, 12, "KITTI", diagnostics);
  Trajectory trajectory;
  trajectory.name = path.string();
  trajectory.time_base = TimeBase::Index;
  trajectory.up = WorldUp::MinusY;
  for (std::size_t row = 0; row < table.lines.size(); ++row) {
    const TextLine& line = table.lines[row];
    if (line.fields.size() != 12) {
      throw InputError(
          fmt::format("{}: {} columns, a KITTI line has exactly 12", table.where(line), line.fields.size()));
    }
    Eigen::Matrix4d world_from_camera = Eigen::Matrix4d::Identity();
    for (int i = 0; i < 12; ++i) {
      world_from_camera(i / 4, i % 4) = table.number(line, static_cast<std::size_t>(i));
    }
    if (!world_from_camera.allFinite()) {
      diagnostics.report(Severity::Warning, "pose_not_finite",
                         table.where(line) + ": a pose with NaN or infinity is left out");
      continue;
    }
    // The row is the only clock; rows that are left out must not shift the later ones.
    const Time index = Time::fromNanoseconds(static_cast<int64_t>(row) * 1'000'000'000);
    trajectory.poses.push_back({index, Rigid3::fromMatrix(world_from_camera, table.where(line).c_str())});
  }
  return trajectory;
}

}  // namespace lodeline
