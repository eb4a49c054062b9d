#pragma once

#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/problem/state/camera_states.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Reports a secondary camera whose estimated position differs from its calibration
/// (FactorBuilder::placement). All lengths were wrong by the same fraction as its distance from camera 0
/// until the correction was found.
class BaselineMonitor {
 public:
  explicit BaselineMonitor(const Rig& rig);

  /// Adds the corrections estimated at a frame; reports each camera once, as a Warning.
  void add(Time time, const CameraCorrections& corrections, Diagnostics* diagnostics);

 private:
  struct Baseline {
    std::string camera;
    Rigid3 camera0_from_camera;  ///< by calibration
    int frames_off = 0;          ///< in a row
    bool is_reported = false;
  };
  std::vector<Baseline> baselines_;  ///< of camera 1, 2, ...
};

}  // namespace lodeline
