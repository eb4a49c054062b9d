#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lodeline/estimate.h"
#include "lodeline/output/report/summary_lines.h"

namespace lodeline {

/// Counts the frames of a run by the status of each sensor, for the sensors that report a SensorRow.
class SensorFrames {
 public:
  void add(const std::vector<SensorRow>& rows);
  /// One line for each sensor: the share of each status.
  void describe(SummaryLines* lines) const;
  /// Adds SENSOR.frames.STATUS.
  void addTo(nlohmann::ordered_json* json) const;

 private:
  std::map<std::string, std::map<std::string, int>> frames_;  ///< by sensor and status
};

}  // namespace lodeline
