#pragma once

#include "lodeline/api/estimation_loop.h"
#include "lodeline/api/run_settings.h"
#include "lodeline/odometry.h"
#include "lodeline/util/settings/settings.h"

namespace lodeline {

struct OdometrySettings::Values {
  RunSettings options;
  Settings settings;  ///< bound to the options
};

struct Odometry::Implementation {
  EstimationLoop loop;
  bool has_ended = false;
  bool has_pose = false;
  bool are_last_landmarks_taken = false;
};

}  // namespace lodeline
