#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lodeline/geometry/types.h"
#include "lodeline/util/time/time.h"

namespace lodeline {

/// A corrected reading of the record that a calibration was made from.
struct CorrectedReading {
  Time time;
  Vec3 field_M = Vec3::Zero();  ///< T
};

/// How the hard iron changed while a calibration was recorded: to first order an offset d of the corrected
/// field changes its size by u . d, with u the field's direction, so that a stretch of readings along several
/// directions tells the offset that it has on top of the calibration's.
struct HardIronChange {
  /// A step between two neighbouring stretches: a current that was switched, iron that came near.
  struct Step {
    Time time;
    double size_T = 0.0;
    double sigma_T = 0.0;  ///< of its largest component
  };
  std::optional<Step> step;
  double spread_T =
      0.0;  ///< of four stretches' offsets, one sigma per axis, beyond their noise; 0 if not significant
};

/// `field_strength_T`: that corrected readings should have. In order of time.
HardIronChange findHardIronChange(std::span<const CorrectedReading> readings, double field_strength_T);

}  // namespace lodeline
