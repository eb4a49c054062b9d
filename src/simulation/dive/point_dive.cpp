#include "simulation/dive/point_dive.h"

#include <memory>

#include "simulation/dive/vehicle_dive.h"
#include "simulation/rendering/cave/traced_scene.h"

namespace lodeline {
namespace {

constexpr double kPointsPerMetre = 400.0;

}  // namespace

PointDive makePointDive(const DiveMotionOptions& motion_options, const MountedRig& mounted,
                        const ImuErrors& imu) {
  CenterlineOptions passage_options;
  passage_options.seed = motion_options.seed;
  passage_options.length_m = motion_options.path_length_m * (motion_options.round_trip ? 0.5 : 1.0);
  const Centerline passage = Centerline::generate(passage_options);
  Motion motion = makeDiveMotion(passage, motion_options, mounted.diver_from_body);
  const Vec3 shift = motion.worldShift();
  const Centerline moved = passage.translated(shift);
  PointDive dive{mounted, moved, std::move(motion),
                 passageLandmarks(moved, kPointsPerMetre, motion_options.seed), shift};
  dive.mounted.rig.imu.noise = statedNoise(imu);
  return dive;
}

PointDive makeCaveDive(const CavePlanOptions& cave, const DiveMotionOptions& motion_options,
                       const MountedRig& mounted, const ImuErrors& imu) {
  const CavePlan plan = planCave(cave);
  Motion motion = makePlannedMotion(plan, cave, motion_options, mounted.diver_from_body);
  const Vec3 shift = motion.worldShift();
  // The walls of a chamber are four times as far around as those of a passage.
  const double points_per_metre = kPointsPerMetre * (cave.shape == CaveShape::Room ? 3.0 : 1.0);
  PointDive dive{mounted, plan.route.tracks.front().translated(shift), std::move(motion),
                 caveLandmarks(plan.cave.translated(shift), points_per_metre, cave.seed), shift};
  dive.mounted.rig.imu.noise = statedNoise(imu);
  return dive;
}

PointSimulation VehicleDive::simulate(const PointSimulationOptions& changed) const {
  PointSimulationOptions fresh = changed;
  // The phases of the thrusters begin anew with each simulation.
  if (fresh.vehicle && fresh.vehicle->shake) fresh.vehicle->shake = makeShaking(dive);
  return PointSimulation(dive.motion, landmarks, trueRig(), givenRig(), fresh);
}

VehicleDive makeVehicleDive(const Scenario& scenario) {
  Dive dive = makeDive(scenario);
  TriangleMesh world = vehicleWorld(dive);
  LandmarkField landmarks = vehicleLandmarks(dive, world);
  const auto scene = std::make_shared<const TracedScene>(std::move(world));
  const RangeFunction range = [scene](const Vec3& origin_W, const Vec3& direction_W) {
    return scene->range(origin_W, direction_W);
  };
  PointSimulationOptions options;
  options.seed = noiseSeed(scenario);
  options.start = dive.start;
  options.frame_rate_hz = scenario.rig.camera_rate_hz;
  options.imu = dive.errors.imu;
  options.magnetometer = {dive.field_W, dive.disturbances, dive.errors.magnetometer};
  options.vehicle = {range,
                     dive.errors.dvl,
                     dive.errors.altimeter,
                     dive.loads,
                     dive.errors.current_sensor,
                     makeShaking(dive)};
  return {std::move(dive), std::move(landmarks), range, options};
}

}  // namespace lodeline
