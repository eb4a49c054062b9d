#include "simulation/rendering/board/board_panel.h"

#include <memory>

#include "lodeline/board/board_print.h"

namespace lodeline {
namespace {

constexpr double kMargin_m = 0.04;   // white, around the squares of the print
constexpr double kWall_m = 0.35;     // distance of the wall behind the panel
constexpr double kWallHalf_m = 4.0;  // half the edge of the wall

}  // namespace

PrintedPanel boardPanel(const CalibrationBoard& board, const Rigid3& world_from_board) {
  const auto print = std::make_shared<const BoardPrint>(board);
  return {world_from_board, [print](double x_m, double y_m) { return print->isBlack(x_m, y_m); }};
}

TriangleMesh makeBoardMesh(const CalibrationBoard& board, const Rigid3& world_from_board) {
  const Vec3 centre_T(0.5 * board.width_m(), 0.5 * board.height_m(), 0.0);
  const double border_m = board.gap_m() + kMargin_m;
  TriangleMesh mesh;
  addRectangle(centre_T, 0.5 * board.width_m() + border_m, 0.5 * board.height_m() + border_m,
               Material::of(0.80f, 0.0f), world_from_board, &mesh);
  addRectangle(centre_T - kWall_m * Vec3::UnitZ(), kWallHalf_m, kWallHalf_m, Material::of(0.35f, 0.7f),
               world_from_board, &mesh);
  mesh.computeNormals();
  return mesh;
}

}  // namespace lodeline
