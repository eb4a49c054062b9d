#pragma once

#include "lodeline/problem/state/window.h"

namespace lodeline {

/// Parameter blocks of the depth gauge in a window; all null where it is not fused.
struct DepthStates {
  static constexpr const char* kOffset = "depth_at_origin";  ///< d_0, m
  static constexpr const char* kScale = "depth_scale";       ///< k
  static constexpr const char* kLag = "depth_lag";           ///< tau, s

  explicit DepthStates(const Window& window)
      : offset(window.findGlobal(kOffset)), scale(window.findGlobal(kScale)), lag(window.findGlobal(kLag)) {}

  explicit operator bool() const { return offset != nullptr; }
  double offset_m() const { return offset->value[0]; }
  double density_ratio() const { return scale->value[0]; }
  double lag_s() const { return lag->value[0]; }

  ParameterBlock* offset;
  ParameterBlock* scale;
  ParameterBlock* lag;
};

}  // namespace lodeline
