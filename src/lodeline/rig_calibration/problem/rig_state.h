#pragma once

#include <array>
#include <memory>
#include <vector>

#include "lodeline/cameras/ports/refractive_camera.h"
#include "lodeline/factors/parameters.h"
#include "lodeline/rig_calibration/record/board_record.h"

namespace lodeline {

constexpr int kPortSize = 4;

/// Parameters of one camera as blocks for the solver.
struct CameraState {
  explicit CameraState(const CameraCalibration& calibration);

  CameraCalibration base;    ///< all that is not estimated, and the port from which `port` counts
  std::vector<double> lens;  ///< fx, fy, cx, cy (px) and the parameters of the model
  /// Change of the port from `base`: flat: tilts of the normal about x and y of C (rad), distance (m); dome:
  /// centre (m). Then that of the refractive index of the water.
  std::array<double, kPortSize> port = {};
  std::array<double, kPoseSize> body_from_camera = {};
  double delay_change_s = 0.0;  ///< to add to RigState::delay_s
  double sigma_px = 1.0;        ///< of a corner, per axis

  /// The camera of the present values; null where they are no camera. See refresh().
  std::shared_ptr<const Camera> camera;
  const RefractiveCamera* behind_port = nullptr;  ///< `camera` where it has a port

  /// The calibration of the present values, without the delay.
  CameraCalibration calibration() const;
  /// Makes `camera` from the present values.
  void refresh();
};

/// State of the body at the time of a frame.
struct FrameState {
  const BoardFrame* seen = nullptr;
  std::array<double, kPoseSize> world_from_body = {};
  std::array<double, kMotionSize> motion = {};
  Vec3 gyroscope_reading_B = Vec3::Zero();  ///< at the time of the frame, rad/s
};

/// Everything that a calibration estimates. The world W has its origin at that of the board. Without an IMU,
/// W is the board frame T and the body is the first camera.
struct RigState {
  std::vector<CameraState> cameras;
  std::vector<FrameState> frames;
  double delay_s = 0.0;                      ///< of the images: stamp + delay = IMU clock
  Quat level_from_board = Quat::Identity();  ///< R_W_T = exp([tilt, 0]) level_from_board
  std::array<double, 2> tilt = {};           ///< about x and y of W, rad

  Quat worldFromBoard() const;
  Time timeOf(const FrameState& frame) const { return frame.seen->stamp + Duration::fromSeconds(delay_s); }
};

}  // namespace lodeline
