#include "simulation/motion/dive_motion.h"

#include <cmath>
#include <numbers>
#include <vector>

#include "simulation/motion/hand_motion.h"
#include "simulation/shared/random.h"
#include "simulation/shared/waves.h"

namespace lodeline {
namespace {

constexpr double kPathKnot_s = 0.5;

// Position of the diver within the cross-section: a slowly varying fraction of the free space. The way back
// has a different one close to the first.
class Line {
 public:
  explicit Line(uint64_t seed)
      : side_(seed, "dive/side", 9.0, 60.0),
        side_back_(seed, "dive/side-back", 9.0, 60.0),
        rise_(seed, "dive/rise", 7.0, 40.0),
        rise_back_(seed, "dive/rise-back", 7.0, 40.0) {}

  Vec3 at(const PassageStation& station, double turn) const {
    const double s = station.arc_length_m;
    const double side = std::tanh(0.5 * side_(s) + 0.35 * turn * side_back_(s));
    const double rise = std::tanh(0.5 * rise_(s) + 0.35 * turn * rise_back_(s));
    const Vec3 left = Vec3::UnitZ().cross(station.tangent_W).normalized();
    return station.position_W + 0.5 * station.width_m * kCorridorShareOfHalfWidth * side * left +
           0.5 * station.height_m * kCorridorShareOfHalfHeight * rise * Vec3::UnitZ();
  }

 private:
  Waves side_, side_back_, rise_, rise_back_;
};

double unwrapped(double angle, double near) {
  return angle + 2.0 * std::numbers::pi * std::round((near - angle) / (2.0 * std::numbers::pi));
}

/// 0 on the way in and 1 on the way back, for any number of half turns.
double wayBack(double turns) {
  if (turns <= 1.0 + 1e-9) return turns;
  const double rest = std::fmod(turns, 2.0);
  return rest <= 1.0 ? rest : 2.0 - rest;
}

MotionChannels makeChannels(const SwimRoute& route, const DiveMotionOptions& o, const SwimPlan& plan) {
  const Line line(o.seed);
  const auto trackAt = [&](double t) -> const Centerline& { return route.trackOf(plan.leg(t)); };
  const auto positionAt = [&](double t) {
    return line.at(trackAt(t).at(plan.arcLength(t)), wayBack(plan.turn(t)));
  };
  const auto coordinate = [&](int axis) {
    return motionSpline(o.duration_s, kPathKnot_s, [&](double t) { return positionAt(t)[axis]; });
  };
  MotionChannels channels;
  channels.east.splines.push_back(coordinate(0));
  channels.north.splines.push_back(coordinate(1));
  channels.up.splines.push_back(coordinate(2));

  // The diver looks a little ahead along the passage.
  constexpr double kLookAhead_m = 1.0;
  const auto aheadAt = [&](double t) {
    const double way = 1.0 - 2.0 * wayBack(plan.turn(t));
    return trackAt(t).at(plan.arcLength(t) + way * kLookAhead_m).tangent_W;
  };
  const double turn_angle = Random(o.seed, "dive/turn").sign() * std::numbers::pi;
  double heading = std::atan2(aheadAt(0.0).y(), aheadAt(0.0).x());
  channels.yaw.splines.push_back(motionSpline(o.duration_s, kPathKnot_s, [&](double t) {
    const Vec3 ahead = aheadAt(t);
    heading = unwrapped(std::atan2(ahead.y(), ahead.x()), heading);
    return heading + turn_angle * plan.turn(t);
  }));
  channels.pitch.splines.push_back(motionSpline(o.duration_s, kPathKnot_s, [&](double t) {
    const double way = 1.0 - 2.0 * wayBack(plan.turn(t));
    return -0.8 * way * std::asin(aheadAt(t).z());
  }));
  return channels;
}

}  // namespace

Motion makeRouteMotion(const SwimRoute& route, const DiveMotionOptions& o, const Rigid3& diver_from_body) {
  SwimPlanOptions plan_options;
  plan_options.seed = o.seed;
  plan_options.duration_s = o.duration_s;
  for (const SwimLeg& leg : route.legs) plan_options.legs_m.push_back(leg.to_m - leg.from_m);
  plan_options.starts_at_rest = o.starts_at_rest;
  plan_options.start_rest_s = o.start_rest_s;
  plan_options.turn_s = o.turn_s;
  plan_options.stops_per_minute = o.stops_per_minute;
  plan_options.still_phases = o.still_phases;
  const SwimPlan plan(plan_options);
  MotionChannels channels = makeChannels(route, o, plan);
  HandMotionOptions hand;
  hand.seed = o.seed;
  hand.duration_s = o.duration_s;
  hand.liveliness = o.liveliness;
  hand.activity = [&](double t) { return plan.activity(t); };
  hand.kick = [&](double t) { return plan.kick(t) * plan.activity(t); };
  addHandMotion(hand, channels);
  return Motion(std::move(channels), diver_from_body, o.duration_s);
}

Motion makeDiveMotion(const Centerline& centerline, const DiveMotionOptions& o,
                      const Rigid3& diver_from_body) {
  const double nominal_m = o.path_length_m * (o.round_trip ? 0.5 : 1.0);
  const Motion first =
      makeRouteMotion(straightRoute(centerline, nominal_m, o.round_trip), o, diver_from_body);
  // Swaying and the varying line make the path longer than the passage, so the second draft covers a shorter
  // passage.
  const double ratio = o.path_length_m / pathLength(first, 0.0, o.duration_s);
  return makeRouteMotion(straightRoute(centerline, nominal_m * ratio, o.round_trip), o, diver_from_body);
}

}  // namespace lodeline
