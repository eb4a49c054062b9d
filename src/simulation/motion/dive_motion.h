#pragma once

#include "simulation/motion/swim_plan.h"
#include "simulation/rendering/cave/centerline.h"
#include "simulation/shared/motion.h"

namespace lodeline {

struct DiveMotionOptions {
  uint64_t seed = 1;
  double duration_s = 600.0;
  double path_length_m = 150.0;  ///< of the body, there and back
  bool round_trip = true;
  bool starts_at_rest = true;
  double start_rest_s = 4.0;
  double turn_s = 10.0;
  double stops_per_minute = 0.6;
  double liveliness = 1.0;  ///< scales swaying, sweeps, kicks and tremor alike; 0 glides
  std::vector<StillPhase> still_phases;
};

/// A swim along the passage and (usually) back on nearly the same line: fin kicks with surge, roll and yaw at
/// the kick's frequency and its double, breathing, slow swaying, sweeps of the hand-held rig, tremor, halts.
/// Path length within 1 % of what is asked for. Throws UsageError as SwimPlan does.
Motion makeDiveMotion(const Centerline& centerline, const DiveMotionOptions& options,
                      const Rigid3& diver_from_body);

}  // namespace lodeline
