#include "lodeline/evaluation/trajectory/pose_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/pose_rows.h"
#include "lodeline/evaluation/trajectory/read_formats.h"
#include "lodeline/io/tables/pose_columns.h"
#include "lodeline/io/tables/text_lines.h"
#include "lodeline/io/tables/units.h"

namespace lodeline {
namespace {

/// Contents of a table's columns.
struct PoseLayout {
  std::optional<TimeColumn> time;  ///< none: the rows are counted
  PoseColumns columns;
  std::optional<std::size_t> matrix;  ///< first of the 12 numbers of a 3x4 matrix; else `columns`
  WorldUp up = WorldUp::Z;
};

PoseLayout quaternionLayout(std::size_t first, bool w_first) {
  PoseLayout layout;
  layout.time = TimeColumn{0, "column 1", {}, 1, {}, {}, 0};
  layout.columns.position = {first, first + 1, first + 2};
  layout.columns.rotation = w_first ? std::array{first + 4, first + 5, first + 6, first + 3}
                                    : std::array{first + 3, first + 4, first + 5, first + 6};
  return layout;
}

PoseLayout matrixLayout(std::size_t first) {
  PoseLayout layout;
  if (first > 0) layout.time = TimeColumn{0, "column 1", {}, 1, {}, {}, 0};
  layout.matrix = first;
  // KITTI's cameras look along z with y down; a table with times has no such convention.
  if (first == 0) layout.up = WorldUp::MinusY;
  return layout;
}

PoseLayout layoutOfHeader(const PoseRows& rows, Diagnostics& diagnostics) {
  PoseLayout layout;
  layout.time = findTimeColumns(rows.columns()).front();
  layout.columns = *findPoseColumns(rows.columns());
  if (!layout.columns.unknown_unit.empty()) {
    throw InputError(fmt::format("{}: unit '{}' of the columns of the position is not known; known are {}",
                                 rows.name(), layout.columns.unknown_unit, knownUnits(Quantity::Length)));
  }
  if (layout.columns.w_is_assumed_first) {
    diagnostics.report(Severity::Warning, "quaternion_order",
                       fmt::format("{}: the columns q0 to q3 are taken for w, x, y, z", rows.name()));
  }
  return layout;
}

/// Layout of OpenVINS tables, whose header names blocks of columns: `# timestamp(s) q p v bg ba ...` for 1,
/// 4, 3, 3, ... of them.
std::optional<PoseLayout> layoutOfBlocks(const PoseRows& rows) {
  for (const std::string& line : rows.preamble()) {
    const std::vector<std::string> words = ColumnName(line).words;
    std::optional<std::size_t> position, rotation;
    const auto begin = std::find_if(words.begin(), words.end(),
                                    [](const std::string& word) { return word == "q" || word == "p"; });
    if (begin == words.end() || !ColumnName(line).hasStem({"time", "stamp"})) continue;
    std::size_t column = 1;
    for (auto word = begin; word != words.end() && (*word == "q" || *word == "p" || *word == "v"); ++word) {
      if (*word == "q" && !rotation) rotation = column;
      if (*word == "p" && !position) position = column;
      column += *word == "q" ? 4 : 3;
    }
    if (!position || !rotation || column > rows.columnCount()) continue;
    PoseLayout layout = quaternionLayout(1, false);
    for (std::size_t i = 0; i < 3; ++i) layout.columns.position[i] = *position + i;
    for (std::size_t i = 0; i < 4; ++i) layout.columns.rotation[i] = *rotation + i;
    return layout;
  }
  return std::nullopt;
}

PoseLayout layoutOfNumbers(const PoseRows& rows, Diagnostics& diagnostics) {
  const std::size_t count = rows.columnCount();
  const bool has_matrix = (count == 12 || count == 16) && rows.areMatrices(0);
  const bool is_tum = count == 12 && !has_matrix && rows.areQuaternions(4) && rows.size() > 1;
  if (has_matrix || (count == 12 && !is_tum)) return matrixLayout(0);
  if ((count == 13 || count == 17) && rows.areMatrices(1)) return matrixLayout(1);
  if (count < 8) {
    throw InputError(fmt::format(
        "{}: {} columns fit no known trajectory layout (a time, position and quaternion: 8 or "
        "more; a 3x4 matrix: 12, with a time 13); {} a header such as "
        "`timestamp [s], x, y, z, qx, qy, qz, qw`",
        rows.where(0), count,
        rows.unknownHeader().empty()
            ? "name the columns in"
            : fmt::format("'{}' names no time, position and quaternion; a pose needs all of them, "
                          "and",
                          excerpt(rows.unknownHeader()))));
  }
  const bool has_nanoseconds = rows.timesAreNanoseconds();
  const bool w_first = has_nanoseconds && rows.hasSeparators();
  if (has_nanoseconds && !w_first && !rows.timesHaveDecimals()) {
    diagnostics.report(
        Severity::Warning, "quaternion_order",
        fmt::format("{}: nanoseconds between blanks without a header; the quaternion is taken for x y "
                    "z w (--format euroc: w x y z)",
                    rows.name()));
  }
  return quaternionLayout(1, w_first);
}

PoseLayout layoutOfFormat(TrajectoryFormat format, const PoseRows& rows) {
  const std::size_t needed = format == TrajectoryFormat::Kitti ? 12 : 8;
  const bool fits =
      format == TrajectoryFormat::Kitti ? rows.columnCount() == needed : rows.columnCount() >= needed;
  if (!fits) {
    throw InputError(fmt::format("{}: {} columns, a {} row has {}{}", rows.where(0), rows.columnCount(),
                                 toString(format), needed,
                                 format == TrajectoryFormat::Kitti ? "" : " or more"));
  }
  return format == TrajectoryFormat::Kitti ? matrixLayout(0)
                                           : quaternionLayout(1, format == TrajectoryFormat::Euroc);
}

PoseLayout layoutOf(const PoseRows& rows, std::optional<TrajectoryFormat> format, Diagnostics& diagnostics) {
  if (format) return layoutOfFormat(*format, rows);
  if (!rows.columns().empty()) return layoutOfHeader(rows, diagnostics);
  const std::optional<PoseLayout> blocks = layoutOfBlocks(rows);
  return blocks ? *blocks : layoutOfNumbers(rows, diagnostics);
}

std::optional<Rigid3> poseOf(const PoseLayout& layout, const PoseRows& rows, std::size_t row,
                             Diagnostics& diagnostics) {
  const std::string where = rows.where(row);
  if (!layout.matrix) {
    const auto& p = layout.columns.position;
    const auto& q = layout.columns.rotation;
    const auto value = [&](std::size_t column) { return rows.number(row, column); };
    const Vec3 position_m = layout.columns.position_to_m * Vec3(value(p[0]), value(p[1]), value(p[2]));
    return poseFromNumbers(where, position_m, Quat(value(q[3]), value(q[0]), value(q[1]), value(q[2])),
                           diagnostics);
  }
  const Eigen::Matrix4d world_from_camera = rows.matrix(row, *layout.matrix);
  if (!world_from_camera.allFinite()) {
    diagnostics.report(Severity::Warning, "pose_not_finite",
                       where + ": a pose with NaN or infinity is left out");
    return std::nullopt;
  }
  return Rigid3::fromMatrix(world_from_camera, where.c_str());
}

}  // namespace

Trajectory readPoseTable(std::unique_ptr<ByteSource> bytes, const std::string& name,
                         std::optional<TrajectoryFormat> format, Diagnostics& diagnostics) {
  PoseRows rows(std::move(bytes), name, format.has_value(), diagnostics);
  const PoseLayout layout = layoutOf(rows, format, diagnostics);
  Trajectory trajectory;
  trajectory.name = name;
  trajectory.up = layout.up;
  trajectory.rows = rows.size();
  if (!layout.time) trajectory.time_base = TimeBase::Index;
  const TimeUnit unit = layout.time ? rows.timeUnit(*layout.time, diagnostics) : TimeUnit::Seconds;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const std::optional<Rigid3> pose = poseOf(layout, rows, row, diagnostics);
    if (!pose) continue;
    // In a table without times the row number is the time; skipped rows must not shift the later ones.
    const Time time = layout.time ? rows.time(row, *layout.time, unit)
                                  : Time::fromNanoseconds(static_cast<int64_t>(row) * 1'000'000'000);
    trajectory.poses.push_back({time, *pose});
  }
  return trajectory;
}

}  // namespace lodeline
