#pragma once

#include <array>

#include "lodeline/sensors/measurements.h"

namespace lodeline {

/// Finds readings at the end of a sensor's range. An axis is taken for saturated at its greatest (or least)
/// reading once it has stayed there, figure by figure, for ten readings although its changes are otherwise
/// larger than twice what it resolves. Or it stayed there thrice, came there each time by a step larger than
/// it resolves, and went far away in between: peaks of motion differ in height and are round. A reading
/// beyond such an end shows that it was none.
class SaturationDetector {
 public:
  /// Readings in order, each once. True where one of the axes is at such an end.
  bool isSaturated(const ImuSample& sample);

 private:
  struct Axis;
  /// One end of one axis; the lower end with signs reversed.
  struct End {
    double value = -1e300;
    int stay = 0;  ///< readings on end at `value`
    int plateaus = 0;
    double step = 0.0;  ///< by which the present stay was reached
    double away = 0.0;  ///< farthest from `value` since the last plateau
    bool add(double before, double reading, const Axis& axis);
  };
  struct Axis {
    bool begun = false;
    double before = 0.0;
    double least = 0.0, greatest = 0.0;
    double resolution = 1e300;  ///< least change that was seen
    double change = 0.0;        ///< mean size of the last changes
    End upper, lower;
    bool add(double reading);
  };
  std::array<Axis, 6> axes_;
};

}  // namespace lodeline
