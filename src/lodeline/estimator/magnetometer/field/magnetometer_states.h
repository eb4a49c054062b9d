#pragma once

#include <cmath>

#include "lodeline/problem/options/magnetometer_options.h"
#include "lodeline/problem/state/window.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Parameter blocks of the magnetometer in a window; all null unless its use is Absolute.
struct MagnetometerStates {
  static constexpr const char* kField = "magnetic_field";              ///< m_W, T
  static constexpr const char* kOffset = "magnetometer_offset";        ///< o_B, T
  static constexpr const char* kDisturbance = "magnetic_disturbance";  ///< d_W, T

  explicit MagnetometerStates(const Window& window)
      : field(window.findGlobal(kField)),
        offset(window.findGlobal(kOffset)),
        disturbance(window.findGlobal(kDisturbance)) {}

  Vec3 field_W() const { return Vec3(field->value.data()); }
  Vec3 offset_B() const { return Vec3(offset->value.data()); }
  Vec3 disturbance_W() const { return Vec3(disturbance->value.data()); }

  ParameterBlock* field;
  ParameterBlock* offset;
  ParameterBlock* disturbance;
};

/// Sigma of the residual hard iron in a magnetometer's readings at the start of a dive, T per axis.
inline double offsetSigma(const MagnetometerCalibration& calibration, const MagnetometerOptions& options) {
  if (!calibration.is_calibrated) return options.uncalibrated_offset_sigma_T;
  return std::hypot(options.offset_sigma_T,
                    calibration.hard_iron_sigma_T.value_or(options.unstated_offset_sigma_T));
}

}  // namespace lodeline
