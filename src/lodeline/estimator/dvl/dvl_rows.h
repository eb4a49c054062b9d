#pragma once

#include <string>
#include <vector>

#include "lodeline/estimator/dvl/dvl_measurement.h"
#include "lodeline/rig.h"

namespace lodeline {

/// What a reading of a DVL is good for.
struct DvlReading {
  Time time;
  std::vector<DvlRow> rows;  ///< empty without lock
  bool is_velocity = false;  ///< rows are axes, not beams
  double sigma_m_per_s = 0.0;
  std::string fault;  ///< values that no instrument measures, in words; empty where all are possible
};

/// The rows of a reading: its beams, or the axes of its velocity where no beam has a velocity. Left out are
/// numbers that are not finite, speeds over 10 m/s, beams that the calibration does not have, and readings
/// whose velocities are all exactly 0, with which instruments and drivers stand for "nothing measured".
DvlReading readRows(const DvlSample& sample, const DvlCalibration& dvl);

}  // namespace lodeline
