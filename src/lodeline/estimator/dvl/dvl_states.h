#pragma once

#include "lodeline/estimator/dvl/dvl_factor.h"
#include "lodeline/estimator/state/window.h"

namespace lodeline {

/// Parameter blocks of the DVL in a window; all null where it is not fused.
struct DvlStates {
  static constexpr const char* kScale = "dvl_scale";                ///< s, relative
  static constexpr const char* kMisalignment = "dvl_misalignment";  ///< m, rad

  explicit DvlStates(const Window& window)
      : scale(window.findGlobal(kScale)), misalignment(window.findGlobal(kMisalignment)) {}

  explicit operator bool() const { return scale != nullptr; }

  ParameterBlock* scale;
  ParameterBlock* misalignment;
};

}  // namespace lodeline
