#include "lodeline/trajectory.h"

#include <fmt/format.h>

#include <array>

#include "lodeline/diagnostics.h"
#include "lodeline/evaluation/trajectory/pose_table.h"
#include "lodeline/evaluation/trajectory/read_formats.h"
#include "lodeline/io/tables/text_lines.h"
#include "lodeline/util/files/file_kind.h"

namespace lodeline {
namespace {

struct FormatName {
  TrajectoryFormat format;
  const char* name;
};

constexpr std::array<FormatName, 6> kFormatNames = {{{TrajectoryFormat::Table, "table"},
                                                     {TrajectoryFormat::Tum, "tum"},
                                                     {TrajectoryFormat::Kitti, "kitti"},
                                                     {TrajectoryFormat::Euroc, "euroc"},
                                                     {TrajectoryFormat::ColmapText, "colmap-text"},
                                                     {TrajectoryFormat::ColmapBinary, "colmap-binary"}}};

bool isFile(const std::filesystem::path& path) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(path, ignored);
}

TrajectoryFormat detectFormat(const std::filesystem::path& file) {
  if (file.extension() == ".bin") return TrajectoryFormat::ColmapBinary;
  const std::string file_name = file.filename().string();
  if (file_name == "images.txt" || file_name == "images.txt.gz") return TrajectoryFormat::ColmapText;
  TextLines lines(openFile(file), file.string());
  for (std::string_view line; lines.next(&line) && (line.empty() || line.front() == '#');) {
    if (line.find("IMAGE_ID") != std::string_view::npos) return TrajectoryFormat::ColmapText;
  }
  return TrajectoryFormat::Table;
}

/// The file with the trajectory in a folder; the most specific names are tried first.
std::filesystem::path findInFolder(const std::filesystem::path& folder) {
  const std::filesystem::path truth = "state_groundtruth_estimate0";
  const std::array<std::filesystem::path, 10> candidates = {
      "trajectory_refined.tum",
      "trajectory.tum",
      "images.bin",
      "images.txt",
      "mav0" / truth / "data.csv",
      "mav0" / truth / "gt_tum.txt",
      truth / "data.csv",
      truth / "gt_tum.txt",
      "data.csv",
      "gt_tum.txt",
  };
  for (const auto& candidate : candidates) {
    if (isFile(folder / candidate)) return folder / candidate;
  }
  throw InputError(
      fmt::format("{}: no trajectory in this folder; looked for trajectory.tum, images.bin, images.txt "
                  "and mav0/state_groundtruth_estimate0/data.csv",
                  folder.string()));
}

Trajectory readPoses(const TrajectorySource& source, const TrajectoryReadOptions& options,
                     Diagnostics& diagnostics) {
  switch (source.format) {
    case TrajectoryFormat::Table:
      return readPoseTable(openFile(source.file), source.file.string(), std::nullopt, diagnostics);
    case TrajectoryFormat::Tum:
    case TrajectoryFormat::Kitti:
    case TrajectoryFormat::Euroc:
      return readPoseTable(openFile(source.file), source.file.string(), source.format, diagnostics);
    case TrajectoryFormat::ColmapText:
      return readColmapText(source.file, options, diagnostics);
    case TrajectoryFormat::ColmapBinary:
      return readColmapBinary(source.file, options, diagnostics);
  }
  throw std::logic_error("unknown trajectory format");
}

}  // namespace

const char* toString(TrajectoryFormat format) {
  for (const FormatName& entry : kFormatNames) {
    if (entry.format == format) return entry.name;
  }
  throw std::logic_error("unknown trajectory format");
}

TrajectoryFormat trajectoryFormatFromString(const std::string& name) {
  for (const FormatName& entry : kFormatNames) {
    if (name == entry.name) return entry.format;
  }
  throw UsageError(
      fmt::format("unknown trajectory format '{}'; known are table, tum, kitti, euroc, colmap-text and "
                  "colmap-binary",
                  name));
}

TrajectorySource findTrajectory(const std::filesystem::path& path, std::optional<TrajectoryFormat> format) {
  std::error_code ignored;
  const RecognizedFile recognized = recognizeFile(path);
  if (recognized.kind == FileKind::Missing) {
    throw InputError(fmt::format("{}: {}", path.string(), recognized.what));
  }
  const auto file = std::filesystem::is_directory(path, ignored) ? findInFolder(path) : path;
  const bool is_other = !recognized.isFolder() && !recognized.isText() &&
                        recognized.kind != FileKind::Compressed && file.extension() != ".bin";
  if (is_other) refuseFile(recognized, "give a trajectory (TUM, KITTI, EuRoC or COLMAP)");
  return {file, format ? *format : detectFormat(file)};
}

Trajectory readTrajectory(const std::filesystem::path& path, const TrajectoryReadOptions& options,
                          Diagnostics& diagnostics) {
  const TrajectorySource source = findTrajectory(path, options.format);
  Trajectory trajectory = readPoses(source, options, diagnostics);
  if (trajectory.empty()) throw InputError(fmt::format("{}: holds no poses", source.file.string()));
  sortByTime(trajectory, diagnostics);
  return trajectory;
}

}  // namespace lodeline
