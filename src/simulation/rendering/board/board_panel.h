#pragma once

#include "lodeline/board/board_print.h"
#include "simulation/rendering/cave/traced_scene.h"
#include "simulation/rendering/optics/camera_optics.h"

namespace lodeline {

/// A calibration board that hangs before a wall. Its print is a function of the place, so pixels can average
/// it at any resolution.
struct BoardPanel {
  BoardPrint print;
  Rigid3 world_from_board;

  BoardPanel(const CalibrationBoard& board, const Rigid3& world_from_board_in)
      : print(board), world_from_board(world_from_board_in) {}

  /// Number of triangles of the panel; they are the first ones of the mesh.
  static constexpr uint32_t kPanelTriangles = 2;
};

/// Mesh of a white panel with the size of the board and a margin, in front of a rough wall, in W.
TriangleMesh makeBoardMesh(const BoardPanel& panel);

/// Averages the print over the area of each pixel of one image.
class BoardSampler {
 public:
  BoardSampler(const BoardPanel& panel, const CameraOptics& optics, const Rigid3& world_from_camera);

  /// Share of the light that the print reflects at a pixel which sees the panel, relative to white paper.
  float brightness(int x, int y) const;

 private:
  const BoardPanel& panel_;
  const CameraOptics& optics_;
  Mat3 board_from_camera_;
  Vec3 camera_T_;  ///< position of the camera on the board, m
};

}  // namespace lodeline
