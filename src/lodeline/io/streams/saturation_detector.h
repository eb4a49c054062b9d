#pragma once

#include <array>

#include "lodeline/rig.h"

namespace lodeline {

/// Detects readings at the end of a sensor's range. An axis is saturated at its largest (or smallest) reading
/// under one of two conditions. First: it stayed there with equal digits for ten readings, although its usual
/// changes exceed twice its resolution. Second: it stayed there three times, arrived each time with a step
/// larger than its resolution, and went far away in between. Real motion peaks differ in height and are
/// round. A reading beyond such an end disproves it.
class SaturationDetector {
 public:
  /// Tests the next reading; call once per reading, in order. True where an axis is at such an end.
  bool isSaturated(const ImuSample& sample);

 private:
  struct Axis;
  /// One end of the range of one axis; the lower end has reversed signs.
  struct End {
    double value = -1e300;
    int stay = 0;  ///< number of consecutive readings at `value`
    int plateaus = 0;
    double step = 0.0;  ///< step with which the present stay began
    double away = 0.0;  ///< largest distance from `value` since the last plateau
    bool add(double before, double reading, const Axis& axis);
  };
  struct Axis {
    bool begun = false;
    double before = 0.0;
    double least = 0.0, greatest = 0.0;
    double resolution = 1e300;  ///< smallest change observed
    double change = 0.0;        ///< mean magnitude of recent changes
    End upper, lower;
    bool add(double reading);
  };
  std::array<Axis, 6> axes_;
};

}  // namespace lodeline
