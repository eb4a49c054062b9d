#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "lodeline/estimator/sonar/sonar_range_factor.h"
#include "lodeline/problem/factor_builder.h"
#include "lodeline/problem/options/sonar_options.h"
#include "lodeline/problem/state/window.h"

namespace lodeline {

/// The landmarks around a beam, and the surface that they form.
struct LocalSurface {
  struct Member {
    TrackId track = -1;
    double weight = 1.0;  ///< falls to 0 at the edge of the cone
  };
  std::vector<Member> members;  ///< in the order of their tracks
  double range_m = 0.0;         ///< along the beam
  double sigma_m = 0.0;         ///< of the surface at the beam, from the scatter of the landmarks
};

/// Whether a track's landmark may be part of a surface.
using LandmarkChoice = std::function<bool(const FeatureTrack&)>;

/// The surface that a beam meets from a pose of the body, by the landmarks of a window; empty where these are
/// too few, or on one side of the beam, or where the surface lies behind the sonar.
std::optional<LocalSurface> surfaceAlong(const SonarBeam& beam, const Rigid3& world_from_body,
                                         const Window& window, const FactorBuilder& factors,
                                         const SonarOptions& options, const LandmarkChoice& isChosen);

}  // namespace lodeline
