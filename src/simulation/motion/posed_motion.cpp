#include "simulation/motion/posed_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "lodeline/util/angles.h"
#include "simulation/motion/hand_motion.h"
#include "simulation/motion/swim_plan.h"
#include "simulation/shared/random.h"
#include "simulation/shared/waves.h"

namespace lodeline {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

// Motion time: constant until `rest_s`, at normal rate 3 s later.
double wakingTime(double t, double rest_s) {
  constexpr double kPickUp_s = 3.0;
  const double u = (t - rest_s) / kPickUp_s;
  if (u <= 0.0) return 0.0;
  if (u >= 1.0) return kPickUp_s * (u - 0.5);
  return kPickUp_s * (u * u * u - 0.5 * u * u * u * u);
}

MotionChannel constant(double duration_s, double value) {
  MotionChannel channel;
  channel.splines.push_back(motionSpline(duration_s, duration_s, [value](double) { return value; }));
  return channel;
}

// A closed ring around the hull at a distance of 3 m with varying height, as a function of arc length.
class WreckRing {
 public:
  WreckRing(const WreckLayout& wreck, uint64_t seed, double longest_m)
      : wreck_(wreck), rise_(seed, "wreck/rise", 2.0, 8.0) {
    for (int i = 0; length_m_.back() < longest_m; ++i) {
      length_m_.push_back(length_m_.back() + (at(i + 1) - at(i)).norm());
    }
  }

  /// Position on the ring; beyond both ends, extrapolation with the speed of the last segment.
  Vec3 position(double along_m) const {
    const auto above = std::upper_bound(length_m_.begin() + 1, length_m_.end() - 1, along_m);
    const double begin_m = *(above - 1);
    const auto piece = static_cast<double>(above - 1 - length_m_.begin());
    return at(piece + (along_m - begin_m) / (*above - begin_m));
  }

 private:
  static constexpr double kPiecesARound = 400.0;

  Vec3 at(double piece) const {
    constexpr double kDistance_m = 3.0;
    const double round = piece / kPiecesARound;
    const double angle = kTurn * round;
    const double along = (0.5 * wreck_.length_m + kDistance_m) * std::cos(angle);
    const double across = (0.5 * wreck_.width_m + kDistance_m) * std::sin(angle);
    const double c = std::cos(wreck_.azimuth_rad), s = std::sin(wreck_.azimuth_rad);
    const double height = 0.5 * wreck_.height_m + 1.0 + std::tanh(rise_(8.0 * round));
    return wreck_.center_W + Vec3(c * along - s * across, s * along + c * across, height);
  }

  WreckLayout wreck_;
  Waves rise_;
  std::vector<double> length_m_ = {0.0};  ///< arc length at each segment
};

}  // namespace

Motion makeFigureEightMotion(uint64_t seed, double duration_s, const Rigid3& diver_from_body) {
  constexpr double kRest_s = 4.0 + 1.5;  // the splines smooth the start over 1.5 s
  const auto spline = [&](const auto& of) {
    MotionChannel channel;
    channel.splines.push_back(
        motionSpline(duration_s, 0.5, [&](double t) { return of(wakingTime(t, kRest_s)); }));
    return channel;
  };
  MotionChannels c;
  c.east = spline([](double w) { return 0.30 * std::sin(kTurn * w / 6.0); });
  c.north = spline([](double w) { return 0.15 * std::sin(kTurn * w / 3.0); });
  c.up = spline([](double w) { return 0.10 * std::sin(kTurn * w / 9.0); });
  c.yaw = spline([](double w) { return kTurn * w / 37.0; });
  c.pitch = spline([](double w) { return 80.0 * kDegree * std::sin(kTurn * w / 13.0); });
  c.roll = spline([](double w) { return kTurn * w / 8.3; });
  HandMotionOptions hand;
  hand.seed = seed;
  hand.duration_s = duration_s;
  hand.sweeps = false;
  hand.kick = [](double) { return 0.0; };
  hand.activity = [](double t) { return t > kRest_s ? 1.0 : 0.0; };
  addHandMotion(hand, c);
  return Motion(std::move(c), diver_from_body, duration_s);
}

Motion makeMotionAtRest(uint64_t seed, double duration_s, const Rigid3& diver_from_body) {
  Random random(seed, "bench/tilt");
  MotionChannels c;
  c.east = c.north = c.up = constant(duration_s, 0.0);
  c.yaw = constant(duration_s, random.uniform(0.0, kTurn));
  c.pitch = constant(duration_s, random.uniform(-3.0, 3.0) * kDegree);
  c.roll = constant(duration_s, random.uniform(-3.0, 3.0) * kDegree);
  return Motion(std::move(c), diver_from_body, duration_s);
}

Motion makeWreckMotion(const WreckLayout& wreck, uint64_t seed, double duration_s, double path_length_m,
                       bool starts_at_rest, const Rigid3& diver_from_body) {
  const WreckRing ring(wreck, seed, path_length_m);
  const Waves tilt(seed, "wreck/roll", 6.0, 25.0);
  const auto make = [&](double length_m) {
    SwimPlanOptions options;
    options.seed = seed;
    options.duration_s = duration_s;
    options.penetration_m = length_m;
    options.round_trip = false;
    options.starts_at_rest = starts_at_rest;
    options.start_rest_s = std::min(options.start_rest_s, 0.06 * duration_s);
    const SwimPlan plan(options);
    const auto position = [&](double t) { return ring.position(plan.arcLength(t)); };
    const auto coordinate = [&](int axis) {
      MotionChannel channel;
      channel.splines.push_back(motionSpline(duration_s, 0.5, [&](double t) { return position(t)[axis]; }));
      return channel;
    };
    // Aims at the keel line beside the diver, at half height.
    const auto aim = [&](double t) -> Vec3 {
      const Vec3 from = position(t);
      const Vec3 bow(std::cos(wreck.azimuth_rad), std::sin(wreck.azimuth_rad), 0.0);
      const double reach = 0.35 * wreck.length_m;
      const double along = reach * std::tanh((from - wreck.center_W).dot(bow) / reach);
      return wreck.center_W + along * bow + Vec3(0.0, 0.0, 0.5 * wreck.height_m) - from;
    };
    MotionChannels c;
    c.east = coordinate(0);
    c.north = coordinate(1);
    c.up = coordinate(2);
    double yaw = 0.0;
    c.yaw.splines.push_back(motionSpline(duration_s, 0.5, [&](double t) {
      const double wanted = std::atan2(aim(t).y(), aim(t).x());
      return yaw = wanted + kTurn * std::round((yaw - wanted) / kTurn);
    }));
    c.pitch.splines.push_back(
        motionSpline(duration_s, 0.5, [&](double t) { return -std::asin(aim(t).normalized().z()); }));
    c.roll.splines.push_back(motionSpline(
        duration_s, 0.5, [&](double t) { return 15.0 * kDegree * std::tanh(tilt(plan.arcLength(t))); }));
    HandMotionOptions hand;
    hand.seed = seed;
    hand.duration_s = duration_s;
    hand.activity = [&](double t) { return plan.activity(t); };
    hand.kick = [&](double t) { return plan.kick(t) * plan.activity(t); };
    addHandMotion(hand, c);
    return Motion(std::move(c), diver_from_body, duration_s);
  };
  const double ratio = path_length_m / pathLength(make(path_length_m), 0.0, duration_s);
  return make(path_length_m * ratio);
}

}  // namespace lodeline
