#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/rig.h"

namespace lodeline {

/// Writes dvl0/data.csv, which DvlTable reads. The readings decide which of the columns it has: those of the
/// velocity, those of the beams, `sigma`, `track`. Each ping has one row, or one for each of its beams.
class DvlText {
 public:
  explicit DvlText(const std::vector<DvlSample>& pings);

  std::string header() const;
  std::string rows(const DvlSample& ping) const;

 private:
  std::string velocityCells(const DvlSample& ping) const;
  std::string lastCells(const DvlSample& ping) const;

  bool has_velocity_ = false, has_beams_ = false, has_sigma_ = false, has_track_ = false;
};

}  // namespace lodeline
