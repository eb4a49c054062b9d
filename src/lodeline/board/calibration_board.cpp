#include "lodeline/board/calibration_board.h"

#include <fmt/core.h>

#include <cmath>

#include "lodeline/io/calibration/yaml_file.h"

namespace lodeline {
namespace {

int readCount(const char* key, CalibrationMap* map) {
  const double count = map->number(key);
  if (!(count >= 1.0 && count <= 100.0 && count == std::floor(count)))
    throw InputError(fmt::format("{} is {:g}; it must be a number of tags", map->atLine(key), count));
  return static_cast<int>(count);
}

double readWithin(const char* key, double least, double most, CalibrationMap* map) {
  const double value = map->number(key);
  if (!(value >= least && value <= most)) {
    throw InputError(
        fmt::format("{} is {:g}; it must be between {:g} and {:g}", map->atLine(key), value, least, most));
  }
  return value;
}

}  // namespace

Vec3 CalibrationBoard::corner_T(int index) const {
  const int tag = index / 4, corner = index % 4, row = tag / columns;
  const bool is_right = corner == 1 || corner == 2, is_upper = corner >= 2;
  return Vec3(tag % columns * pitch_m() + (is_right ? tag_size_m : 0.0),
              row * pitch_m() + (is_upper ? tag_size_m : 0.0), 0.0);
}

CalibrationBoard readBoard(const std::filesystem::path& file) {
  CalibrationMap map(loadYamlFile(file), file, "");
  const std::string type = map.text("target_type");
  if (type != "aprilgrid") {
    throw InputError(fmt::format(
        "{} is '{}'; boards of AprilTags are supported: target_type: aprilgrid, tagCols, tagRows, tagSize "
        "(m), tagSpacing",
        map.atLine("target_type"), type));
  }
  CalibrationBoard board;
  board.columns = readCount("tagCols", &map);
  board.rows = readCount("tagRows", &map);
  board.tag_size_m = readWithin("tagSize", 1e-3, 10.0, &map);
  board.spacing = readWithin("tagSpacing", 0.01, 2.0, &map);
  map.refuseUnknownKeys();
  if (board.tagCount() > CalibrationBoard::kFamilySize) {
    throw InputError(fmt::format("{}: {} tags; the family 36h11 has {}", file.string(), board.tagCount(),
                                 CalibrationBoard::kFamilySize));
  }
  return board;
}

std::string boardText(const CalibrationBoard& board) {
  return fmt::format("target_type: aprilgrid\ntagCols: {}\ntagRows: {}\ntagSize: {}  # m\ntagSpacing: {}\n",
                     board.columns, board.rows, board.tag_size_m, board.spacing);
}

std::string boardWords(const CalibrationBoard& board) {
  return fmt::format("{} x {} tags of the family 36h11, {:g} mm wide", board.columns, board.rows,
                     1e3 * board.tag_size_m);
}

}  // namespace lodeline
