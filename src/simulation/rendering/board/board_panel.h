#pragma once

#include "lodeline/board/calibration_board.h"
#include "simulation/rendering/board/printed_panel.h"

namespace lodeline {

/// The print of a calibration board.
PrintedPanel boardPanel(const CalibrationBoard& board, const Rigid3& world_from_board);

/// Mesh of a white panel with the size of the board and a margin, in front of a rough wall, in W.
TriangleMesh makeBoardMesh(const CalibrationBoard& board, const Rigid3& world_from_board);

}  // namespace lodeline
