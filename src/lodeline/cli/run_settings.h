#pragma once

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
};

void bindRunSettings(Settings* settings, RunSettings* options);

}  // namespace lodeline
