#pragma once

#include <string>
#include <vector>

#include "lodeline/estimator/state/camera_states.h"
#include "lodeline/sensors/rig.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// Says when a secondary camera turns out to sit elsewhere than its calibration says
/// (FactorBuilder::placement): by as much of its distance from the first camera, every length was wrong until
/// it was found.
class BaselineMonitor {
 public:
  explicit BaselineMonitor(const Rig& rig);

  /// Adds what has been found at a frame; reports each camera once, a Warning.
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
