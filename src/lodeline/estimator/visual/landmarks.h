#pragma once

#include <optional>

#include "lodeline/estimator/options/options.h"
#include "lodeline/estimator/problem/factor_builder.h"
#include "lodeline/estimator/problem/robust_loss.h"
#include "lodeline/estimator/state/window.h"

namespace lodeline {

/// Gives a place in space to tracks that have been seen from far enough apart, hosted at the newest keyframe
/// that sees them, once `min_frames` frames have. Tracks seen by more frames come first when there are more
/// than `max_landmarks`, which holds unless fewer than `least_in_view` are in the newest frame. Returns how
/// many were added.
int createLandmarks(Window& window, const FactorBuilder& factors, const LandmarkOptions& options);

/// Removes observations that contradict the window by more than `max_error_sigmas`, and the landmarks that
/// are then seen too little or lie behind their host, but leaves LandmarkLinearizationCache as they are.
/// Returns the number of observations removed. `errors_sigmas` are those of the same tracks and observations,
/// as from ReprojectionSystem::errors(); `errors`, where given, receives them with what they belong to.
int removeOutliers(Window& window, const std::vector<double>& errors_sigmas, const LandmarkOptions& options,
                   std::vector<ObservationError>* errors = nullptr);
/// The same for a window whose errors are not at hand.
int removeOutliers(Window& window, const FactorBuilder& factors, const LandmarkOptions& options);

/// Root mean square of the whitened reprojection errors of one frame.
struct ReprojectionStatistics {
  int landmarks = 0;  ///< seen in the frame
  int observations = 0;
  double rms_sigmas = 0.0;
};
ReprojectionStatistics reprojectionStatistics(Window& window, const FactorBuilder& factors, FrameId frame);

/// Harmonic mean of the distances of the landmarks that a camera sees in a frame, counted from their hosts,
/// m: flow by translation goes with the inverse distance. Nothing where it sees none at a finite distance.
std::optional<double> meanLandmarkDistance_m(const Window& window, FrameId frame, int camera);

}  // namespace lodeline
