#pragma once

#include <optional>

#include "lodeline/problem/factor_builder.h"
#include "lodeline/problem/options/options.h"
#include "lodeline/problem/robust_loss.h"
#include "lodeline/problem/state/window.h"

namespace lodeline {

/// Triangulates landmarks from tracks with enough parallax that at least `min_frames` frames observe. The
/// host is the newest keyframe that observes the track. Tracks with more observations come first when there
/// are more than `max_landmarks`. That limit holds unless fewer than `least_in_view` are in the newest frame.
/// Returns the number of new landmarks.
int createLandmarks(Window& window, const FactorBuilder& factors, const LandmarkOptions& options);

/// Removes observations whose residual exceeds `max_error_sigmas`, and then landmarks that have too few
/// observations or lie behind their host. Landmarks in the LandmarkLinearizationCache stay unchanged. Returns
/// the number of removed observations. `errors_sigmas`: residual norms of the same tracks and observations,
/// as from ReprojectionSystem::errors(). `errors`, unless null, receives them together with their track and
/// frame.
int removeOutliers(Window& window, const std::vector<double>& errors_sigmas, const LandmarkOptions& options,
                   std::vector<ObservationError>* errors = nullptr);
/// The same for a window whose residuals are not yet computed.
int removeOutliers(Window& window, const FactorBuilder& factors, const LandmarkOptions& options);

/// Root mean square of the whitened reprojection residuals of one frame.
struct ReprojectionStatistics {
  int landmarks = 0;  ///< observed in the frame
  int observations = 0;
  double rms_sigmas = 0.0;
};
ReprojectionStatistics reprojectionStatistics(Window& window, const FactorBuilder& factors, FrameId frame);

/// Harmonic mean of the distances, from their hosts, of the landmarks that a camera observes in a frame, m.
/// It is harmonic because the optical flow of a translation is proportional to the inverse distance. Empty
/// where the camera observes none at a finite distance.
std::optional<double> meanLandmarkDistance_m(const Window& window, FrameId frame, int camera);

}  // namespace lodeline
