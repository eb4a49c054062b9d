#pragma once

#include "simulation/motion/swim_plan.h"
#include "simulation/motion/swim_route.h"
#include "simulation/shared/motion.h"

namespace lodeline {

struct DiveMotionOptions {
  uint64_t seed = 1;
  double duration_s = 600.0;
  double path_length_m = 150.0;  ///< path length of the body, both ways
  bool round_trip = true;
  bool starts_at_rest = true;
  double start_rest_s = 4.0;
  double turn_s = 10.0;
  double stops_per_minute = 0.6;
  double liveliness = 1.0;  ///< common scale of swaying, sweeps, kicks and tremor; 0 is a smooth glide
  std::vector<StillPhase> still_phases;
};

/// Motion of a swim along the passage and (usually) back on nearly the same line. It includes fin kicks with
/// surge, roll and yaw at the kick frequency and its double. Breathing, slow swaying, sweeps of the hand-held
/// rig, tremor and halts are included too. The path length is within 1 % of the requested one. Throws
/// UsageError like SwimPlan.
Motion makeDiveMotion(const Centerline& centerline, const DiveMotionOptions& options,
                      const Rigid3& diver_from_body);

/// The same kind of motion along a route. Places follow the route, so the path of the body is a few per cent
/// longer than the route; `path_length_m` and `round_trip` are not used. Throws UsageError like SwimPlan.
Motion makeRouteMotion(const SwimRoute& route, const DiveMotionOptions& options,
                       const Rigid3& diver_from_body);

}  // namespace lodeline
