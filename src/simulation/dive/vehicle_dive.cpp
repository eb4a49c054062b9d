#include "simulation/dive/vehicle_dive.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <utility>

#include "lodeline/util/angles.h"
#include "simulation/motion/vehicle_motion.h"
#include "simulation/rendering/cave/wreck_mesh.h"
#include "simulation/shared/random.h"
#include "simulation/vehicle/hull_steel.h"
#include "simulation/vehicle/still_ramps.h"
#include "simulation/vehicle/thruster_vibration.h"

namespace lodeline {
namespace {

constexpr double kAltitude_m = 2.0;

VehicleMotionOptions motionOptions(const Scenario& s) {
  VehicleMotionOptions options;
  options.seed = s.seed;
  options.duration_s = s.duration_s;
  options.starts_at_rest = s.starts_at_rest;
  options.start_rest_s = std::min(4.0, 0.06 * s.duration_s);
  return options;
}

WreckOptions wreckOptions(const Dive& dive) {
  WreckOptions options;
  options.seed = dive.scenario.seed;
  options.hull.half_length_m = static_cast<float>(0.5 * dive.wreck->length_m);
  options.hull.half_beam_m = static_cast<float>(0.5 * dive.wreck->width_m);
  options.hull.depth_m = static_cast<float>(dive.wreck->height_m);
  options.hull.open_share = 0.07f;
  options.list_rad = 0.06f;
  options.center_W = dive.wreck->center_W.cast<float>();
  options.heading_rad = static_cast<float>(dive.wreck->azimuth_rad);
  options.seabed_half_m = static_cast<float>(0.5 * dive.wreck->length_m + kWreckApproach_m + 10.0);
  return options;
}

/// Cells of a grid near the path.
class NearPath {
 public:
  NearPath(const Motion& motion, double reach_m) {
    const int reach = static_cast<int>(std::ceil(reach_m / kCell_m));
    for (double t = 0.0; t <= motion.duration_s(); t += 1.0) {
      const auto [east, north] = cellOf(motion.at(t).world_from_body.translation);
      for (int i = -reach; i <= reach; ++i) {
        for (int j = -reach; j <= reach; ++j) cells_.emplace(east + i, north + j);
      }
    }
  }
  bool contains(const Vec3& point_W) const { return cells_.count(cellOf(point_W)) > 0; }

 private:
  static constexpr double kCell_m = 2.0;
  static std::pair<int, int> cellOf(const Vec3& p) {
    return {static_cast<int>(std::floor(p.x() / kCell_m)), static_cast<int>(std::floor(p.y() / kCell_m))};
  }
  std::set<std::pair<int, int>> cells_;
};

}  // namespace

Motion makeTransects(const Scenario& s, const Rigid3& vehicle_from_body, SeaFloorOptions* floor) {
  floor->seed = s.seed;
  const SeaFloor ground(s.seed);
  Motion motion = makeTransectMotion(
      [ground](double east_m, double north_m) {
        return ground.height_m(static_cast<float>(east_m), static_cast<float>(north_m));
      },
      kAltitude_m, s.path_length_m, motionOptions(s), vehicle_from_body);
  constexpr float kMargin_m = 9.0f;
  floor->origin_W = motion.worldShift().cast<float>();
  Vec3 low = Vec3::Zero(), high = Vec3::Zero();
  for (double t = 0.0; t <= motion.duration_s(); t += 0.5) {
    const Vec3& place_W = motion.at(t).world_from_body.translation;
    low = low.cwiseMin(place_W);
    high = high.cwiseMax(place_W);
  }
  floor->low_F = low.cast<float>() - floor->origin_W - Vec3f::Constant(kMargin_m);
  floor->high_F = high.cast<float>() - floor->origin_W + Vec3f::Constant(kMargin_m);
  return motion;
}

WreckLayout steelWreck() {
  WreckLayout wreck;
  wreck.length_m = 40.0;
  wreck.width_m = 12.0;
  wreck.height_m = 6.0;
  return wreck;
}

Motion makeWreckLaps(const Scenario& s, const Rigid3& vehicle_from_body, WreckLayout* wreck) {
  wreck->azimuth_rad = Random(s.seed, "wreck/azimuth").uniform(-180.0, 180.0) * kDegree;
  Motion motion = makeWreckLapMotion(*wreck, s.laps, s.path_length_m, motionOptions(s), vehicle_from_body);
  *wreck = wreck->translated(motion.worldShift());
  return motion;
}

void equipVehicle(Dive& dive) {
  const Scenario& s = dive.scenario;
  if (s.motion == MotionKind::CurrentRamps) {
    dive.loads = rampedLoads();
  } else {
    WaterFlow flow = drawWaterFlow(s.seed);
    if (dive.current) {
      // The current that carries the snow.
      flow = [current = dive.current](double t) -> Vec3 {
        return (current->at(t + 0.5) - current->at(t - 0.5)) / 1.0;
      };
    }
    dive.thrust = std::make_shared<const VehicleThrust>(dive.motion, dive.errors.truth.diver_from_body, flow);
    dive.loads = drawVehicleLoads(dive.thrust, s.duration_s, s.seed);
  }
  if (s.effects.has(Effect::ThrusterCurrents)) {
    dive.disturbances.currents_M = [loads = dive.loads,
                                    fields = dive.errors.truth.rig.currents->fields_T_per_A](double t) {
      return fieldOfCurrents(fields, channelCurrents(loads(t)));
    };
  }
  if (s.effects.has(Effect::Steel)) {
    dive.disturbances.steel = drawHullSteel(dive.wreck.value(), dive.field_W, s.seed);
  }
}

TriangleMesh vehicleWorld(const Dive& dive) {
  if (dive.sea_floor) return makeSeaFloor(*dive.sea_floor);
  if (dive.wreck) return makeWreck(wreckOptions(dive));
  return {};
}

LandmarkField vehicleLandmarks(const Dive& dive, const TriangleMesh& mesh) {
  constexpr double kPerSquareMetre = 40.0, kReach_m = 8.0;
  const NearPath near(dive.motion, kReach_m);
  Random random(dive.scenario.seed, "landmarks");
  std::vector<LandmarkPoint> points;
  double owed = 0.0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.positions[t[0]].cast<double>(), b = mesh.positions[t[1]].cast<double>(),
               c = mesh.positions[t[2]].cast<double>();
    if (!near.contains(a)) continue;
    const Vec3 twice_area = (b - a).cross(c - a);
    if (twice_area.norm() < 1e-9) continue;
    const Vec3 normal = mesh.normals[t[0]].cast<double>().dot(twice_area) < 0.0
                            ? Vec3(-twice_area.normalized())
                            : Vec3(twice_area.normalized());
    for (owed += 0.5 * twice_area.norm() * kPerSquareMetre; owed >= 1.0; owed -= 1.0) {
      double u = random.uniform(), v = random.uniform();
      if (u + v > 1.0) u = 1.0 - u, v = 1.0 - v;
      // Plates are seen from both sides, the floor from above.
      const bool other_side = dive.wreck && std::abs(normal.z()) < 0.9 && random.chance(0.5);
      points.push_back({a + u * (b - a) + v * (c - a), other_side ? Vec3(-normal) : normal});
    }
  }
  return LandmarkField(std::move(points));
}

Shaking makeShaking(const Dive& dive) {
  if (!dive.scenario.effects.has(Effect::Vibration) || !dive.thrust) return {};
  const auto vibration = std::make_shared<ThrusterVibration>(
      [thrust = dive.thrust](double t) { return thrust->at(t); }, VibrationOptions(), dive.scenario.seed);
  return [vibration](double time_s, ImuSample* reading) {
    const ThrusterVibration::Shake shake = vibration->at(time_s);
    reading->specific_force_B += shake.specific_force_B;
    reading->angular_velocity_B += shake.angular_velocity_B;
  };
}

}  // namespace lodeline
