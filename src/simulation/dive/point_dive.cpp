#include "simulation/dive/point_dive.h"

namespace lodeline {

PointDive makePointDive(const DiveMotionOptions& motion_options, const MountedRig& mounted,
                        const ImuErrors& imu) {
  CenterlineOptions passage_options;
  passage_options.seed = motion_options.seed;
  passage_options.length_m = motion_options.path_length_m * (motion_options.round_trip ? 0.5 : 1.0);
  const Centerline passage = Centerline::generate(passage_options);
  Motion motion = makeDiveMotion(passage, motion_options, mounted.diver_from_body);
  const Centerline moved = passage.translated(motion.worldShift());
  constexpr double kPointsPerMetre = 400.0;
  PointDive dive{mounted, moved, std::move(motion),
                 passageLandmarks(moved, kPointsPerMetre, motion_options.seed)};
  dive.mounted.rig.imu.noise = statedNoise(imu);
  return dive;
}

}  // namespace lodeline
