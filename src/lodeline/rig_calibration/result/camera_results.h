#pragma once

#include <span>

#include "lodeline/rig_calibration/problem/rig_problem.h"
#include "lodeline/rig_calibration/result/rig_calibration.h"

namespace lodeline {

/// Sets the sigma of the corners of each camera from the median of their present errors.
void settleCornerSigmas(const CalibrationBoard& board, RigState* state);

/// Removes frames whose median error is far above that of all frames: a wrong start, or a wrong tag.
void dropOutlyingFrames(const CalibrationBoard& board, RigState* state);

/// Results of every camera from a solution and its covariance.
std::vector<CameraCalibrationResult> cameraResults(const BoardRecord& record, const RigState& state,
                                                   const Posterior& posterior, bool has_imu);

/// Standard deviation of the specific force without gravity along the axis of the body with the least, m/s^2.
double leastAcceleration(const RigState& state, std::span<const ImuSample> imu);

}  // namespace lodeline
