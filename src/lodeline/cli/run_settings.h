#pragma once

#include <string>
#include <vector>

#include "lodeline/base/settings.h"
#include "lodeline/data/euroc_source.h"
#include "lodeline/data/synchronizer.h"
#include "lodeline/estimator/odometry.h"

namespace lodeline {

/// Everything that `lodeline run` can be told.
struct RunSettings {
  EurocOptions source;
  SynchronizerOptions synchronizer;
  OdometryOptions odometry;
  std::string magnetometer_calibration;  ///< file of `lodeline calibrate magnetometer`; empty for none
};

void bindRunSettings(Settings* settings, RunSettings* options);

}  // namespace lodeline
