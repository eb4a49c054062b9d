#include "lodeline/evaluation/read_formats.h"

namespace lodeline {

Trajectory readEuroc(const std::filesystem::path& path, Diagnostics& diagnostics) {
  TextTable table = readTextTable(path);
  requireColumns(table, 8, "EuRoC ground-truth", diagnostics);
  Trajectory trajectory;
  trajectory.name = path.string();
  for (const TextLine& line : table.lines) {
    const auto value = [&](std::size_t column) { return table.number(line, column); };
    const Vec3 position_m(value(1), value(2), value(3));
    const Quat rotation(value(4), value(5), value(6), value(7));
    if (const auto pose = poseFromNumbers(table.where(line), position_m, rotation, diagnostics)) {
      trajectory.poses.push_back({table.timeInNanoseconds(line, 0), *pose});
    }
  }
  return trajectory;
}

}  // namespace lodeline
