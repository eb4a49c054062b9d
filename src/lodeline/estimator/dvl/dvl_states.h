#pragma once

#include "lodeline/estimator/dvl/dvl_factor.h"
#include "lodeline/problem/state/window.h"

namespace lodeline {

/// Parameter blocks of the DVL in a window; all null where it is not fused.
struct DvlStates {
  static constexpr const char* kScale = "dvl_scale";                ///< s, relative
  static constexpr const char* kMisalignment = "dvl_misalignment";  ///< m, rad
  static constexpr const char* kCurrent = "dvl_current";            ///< c of the water, world axes, m/s

  /// Sigma of each axis of the current before the first velocity through the water, and its random walk: the
  /// vehicle comes into streams of other speeds.
  static constexpr double kCurrentSigma_m_per_s = 0.2;
  static constexpr double kCurrentWalk_m_per_s_per_sqrt_s = 0.01;

  explicit DvlStates(const Window& window)
      : scale(window.findGlobal(kScale)),
        misalignment(window.findGlobal(kMisalignment)),
        current(window.findGlobal(kCurrent)) {}

  explicit operator bool() const { return scale != nullptr; }

  ParameterBlock* scale;
  ParameterBlock* misalignment;
  ParameterBlock* current;  ///< null before the first velocity through the water
};

}  // namespace lodeline
