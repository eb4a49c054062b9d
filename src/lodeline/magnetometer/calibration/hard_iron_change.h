#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// A corrected reading of the calibration record.
struct CorrectedReading {
  Time time;
  Vec3 field_M = Vec3::Zero();  ///< T
};

/// Change of the hard iron during a calibration record. To first order, an offset d of the corrected field
/// changes its magnitude by u . d, with u the direction of the field. Readings of a stretch along several
/// directions therefore determine its offset relative to the calibration.
struct HardIronChange {
  /// A step between two neighbouring stretches, for example from a switched current or iron brought close.
  struct Step {
    Time time;
    double size_T = 0.0;
    double sigma_T = 0.0;  ///< one sigma of the largest component
  };
  std::optional<Step> step;
  double spread_T = 0.0;  ///< standard deviation per axis of the offsets of four stretches beyond their
                          ///< noise; 0 if not significant
};

/// Finds changes in readings sorted by time. `field_strength_T`: magnitude that corrected readings should
/// have.
HardIronChange findHardIronChange(std::span<const CorrectedReading> readings, double field_strength_T);

}  // namespace lodeline
