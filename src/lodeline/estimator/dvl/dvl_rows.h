#pragma once

#include <string>
#include <vector>

#include "lodeline/estimator/dvl/dvl_measurement.h"
#include "lodeline/rig.h"

namespace lodeline {

/// What a reading of a DVL is good for.
struct DvlReading {
  Time time;
  DvlTrack track = DvlTrack::Bottom;
  std::vector<DvlRow> rows;  ///< empty without lock
  bool is_velocity = false;  ///< rows are axes, not beams
  double sigma_m_per_s = 0.0;
  std::string fault;  ///< values that no instrument measures, in words; empty where all are possible
};

/// The rows of a reading: its beams, or the axes of its velocity where no beam has a velocity. Numbers that
/// are not finite, speeds over 10 m/s and beams without calibration are left out. So are readings whose
/// velocities are all exactly 0, which means "nothing measured".
DvlReading readRows(const DvlSample& sample, const DvlCalibration& dvl);

}  // namespace lodeline
