#pragma once

#include <vector>

#include "lodeline/estimator/sonar/local_surface.h"
#include "lodeline/problem/state/measurement.h"

namespace lodeline {

/// An echo that the gate accepted.
struct SonarEcho {
  double range_m = 0.0;
  double sigma_m = 0.0;  ///< of the sonar itself
  SonarBeam beam;
  /// Pose of the body at the echo, between those of the frame before and of the frame.
  PoseInterpolation between;
  Rigid3 frame_from_echo;  ///< the same pose relative to the frame, as predicted
  /// Factor on the variance of the surface: its errors are correlated over successive echoes.
  double share = 1.0;
};

/// Sonar measurement of a frame: the echoes since the frame before. Each one's factor is a SonarRangeFactor
/// under a Cauchy loss, with its landmarks eliminated (EliminatedLandmarksFactor). The surface is formed anew
/// for each solution by the landmarks that the window has then. In the batch solution, where the frame before
/// may be no state, the poses at the echoes follow the frame alone.
struct SonarMeasurement final : Measurement {
  std::string_view kind;  ///< EchoSource::kName
  std::vector<SonarEcho> echoes;
  SonarOptions options;
  double variance_scale = 1.0;

  std::string_view sensor() const override { return kind; }
  std::vector<Factor> factors(const MeasurementContext& context) const override;
  bool isRelative() const override { return true; }
  bool containsLandmarks() const override { return true; }
  std::shared_ptr<const Measurement> weighted(int count) const override;
};

}  // namespace lodeline
