#pragma once

#include <cstdint>

#include "simulation/shared/motion.h"

namespace lodeline {

/// Where a calibration board hangs relative to the start of a motion.
struct BoardPlace {
  Vec3 centre_W = Vec3::Zero();
  Quat world_from_board = Quat::Identity();  ///< board axes x right, y up, z towards the rig
};

/// Motion of a camera calibration: the hands turn the rig about all axes, 0.45 to 0.9 m before a board, and
/// sweep the board over the whole image. Sets the place of the board.
Motion makeBoardMotion(uint64_t seed, double duration_s, const Rigid3& diver_from_body, BoardPlace* board);

}  // namespace lodeline
