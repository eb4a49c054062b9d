#include "simulation/motion/vehicle_motion.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "lodeline/diagnostics.h"
#include "lodeline/util/angles.h"
#include "simulation/motion/hand_motion.h"
#include "simulation/shared/random.h"
#include "simulation/shared/smoother_step.h"

namespace lodeline {
namespace {

constexpr double kLastRest_s = 2.0;
constexpr double kSpeedRamp_s = 2.5;
constexpr double kMostPauseShare = 0.3;

/// Way along a leg at a time since its begin: an even speed with linear ramps at both ends.
double alongLeg(double since_s, double move_s, double length_m) {
  const double ramp_s = std::min(kSpeedRamp_s, move_s / 3.0);
  const double speed = length_m / (move_s - ramp_s);
  const double u = std::clamp(since_s, 0.0, move_s);
  if (u < ramp_s) return 0.5 * speed * u * u / ramp_s;
  const double left_s = move_s - u;
  if (left_s < ramp_s) return length_m - 0.5 * speed * left_s * left_s / ramp_s;
  return speed * (u - 0.5 * ramp_s);
}

/// Position and heading on a route at every time.
class Schedule {
 public:
  Schedule(const std::vector<VehicleLeg>& route, const VehicleMotionOptions& o) : route_(route) {
    double length_m = 0.0, pauses_s = 0.0;
    for (const VehicleLeg& leg : route) {
      length_m += leg.length_m;
      pauses_s += leg.pause_s;
    }
    rest_s_ = o.starts_at_rest ? o.start_rest_s : 0.0;
    const double free_s = o.duration_s - rest_s_ - kLastRest_s;
    // Short recordings hover less.
    const double pause_share = pauses_s > 0.0 ? std::min(1.0, kMostPauseShare * free_s / pauses_s) : 1.0;
    const double speed = length_m / (free_s - pause_share * pauses_s);
    if (!(free_s > 0.0) || !(speed >= 0.05 && speed <= 1.2)) {
      throw UsageError(
          fmt::format("{:.1f} m in {:.1f} s: a vehicle moves at 0.05 to 1.2 m/s", length_m, o.duration_s));
    }
    double t = rest_s_;
    double yaw = route.front().yaw_rad(0.0);
    for (const VehicleLeg& leg : route) {
      Part part;
      part.begin_s = t;
      part.move_s = leg.length_m / speed;
      part.pause_s = pause_share * leg.pause_s;
      // The heading turns by less than half a turn between legs.
      part.yaw_offset = std::remainder(yaw - leg.yaw_rad(0.0), 2.0 * std::numbers::pi);
      part.yaw_offset = yaw - part.yaw_offset - leg.yaw_rad(0.0);
      yaw = leg.yaw_rad(leg.length_m) + part.yaw_offset;
      t += part.move_s + part.pause_s;
      parts_.push_back(part);
    }
  }

  double rest_s() const { return rest_s_; }

  Vec3 position(double t) const {
    const size_t i = legAt(t);
    return route_[i].position(alongLeg(t - parts_[i].begin_s, parts_[i].move_s, route_[i].length_m));
  }

  double yaw(double t) const {
    const size_t i = legAt(t);
    const Part& part = parts_[i];
    const VehicleLeg& leg = route_[i];
    const double since_s = t - part.begin_s;
    const double here = leg.yaw_rad(alongLeg(since_s, part.move_s, leg.length_m)) + part.yaw_offset;
    if (since_s < part.move_s || i + 1 == route_.size()) return here;
    const double next = route_[i + 1].yaw_rad(0.0) + parts_[i + 1].yaw_offset;
    return here + (next - here) * smootherStep01((since_s - part.move_s) / std::max(part.pause_s, 1e-3));
  }

 private:
  struct Part {
    double begin_s = 0.0, move_s = 0.0, pause_s = 0.0;
    double yaw_offset = 0.0;  ///< whole turns
  };
  size_t legAt(double t) const {
    size_t i = 0;
    while (i + 1 < parts_.size() && t >= parts_[i + 1].begin_s) ++i;
    return i;
  }

  const std::vector<VehicleLeg>& route_;
  std::vector<Part> parts_;
  double rest_s_ = 0.0;
};

/// Pulls of the tether: fast away, slowly back.
void addTugs(const VehicleMotionOptions& o, double rest_s, MotionChannels& c) {
  struct Tug {
    double begin_s;
    Vec3 size_m;
    double yaw_rad;
  };
  std::vector<Tug> tugs;
  Random random(o.seed, "vehicle/tugs");
  for (double t = rest_s + random.uniform(5.0, 20.0); t < o.duration_s - 8.0;
       t += random.uniform(25.0, 60.0)) {
    const double size_m = random.uniform(0.05, 0.14);
    const double azimuth = random.uniform(0.0, 2.0 * std::numbers::pi);
    const double rise = random.uniform(-0.1, 0.4);
    const double yaw = random.sign() * random.uniform(1.0, 5.0) * kDegree;
    tugs.push_back({t, size_m * Vec3(std::cos(azimuth), std::sin(azimuth), rise), yaw});
  }
  const auto course = [](double since_s) {
    return smootherStep01(since_s / 0.5) * (1.0 - smootherStep01((since_s - 0.5) / 5.0));
  };
  const auto spline = [&](const auto& sizeOf) {
    return motionSpline(o.duration_s, 0.1, [&](double t) {
      double sum = 0.0;
      for (const Tug& tug : tugs) sum += sizeOf(tug) * course(t - tug.begin_s);
      return sum;
    });
  };
  c.forward.splines.push_back(spline([](const Tug& tug) { return tug.size_m.x(); }));
  c.left.splines.push_back(spline([](const Tug& tug) { return tug.size_m.y(); }));
  c.above.splines.push_back(spline([](const Tug& tug) { return tug.size_m.z(); }));
  c.yaw.splines.push_back(spline([](const Tug& tug) { return tug.yaw_rad; }));
}

/// Errors of the vehicle's controller.
void addWander(const VehicleMotionOptions& o, double rest_s, MotionChannels& c) {
  const TimeFunction awake = [&](double t) { return t > rest_s ? 1.0 : 0.0; };
  const auto add = [&](MotionChannel& channel, const char* stream, double spacing_s, double sigma) {
    channel.enveloped.push_back(motionNoise(o.seed, stream, o.duration_s, awake, spacing_s, sigma / 0.65));
  };
  add(c.forward, "vehicle/wander/forward", 2.5, 0.02);
  add(c.left, "vehicle/wander/left", 2.5, 0.025);
  add(c.above, "vehicle/wander/above", 2.0, 0.02);
  add(c.yaw, "vehicle/wander/yaw", 1.5, 1.2 * kDegree);
  add(c.pitch, "vehicle/wander/pitch", 1.2, 1.0 * kDegree);
  add(c.roll, "vehicle/wander/roll", 1.2, 1.0 * kDegree);
}

}  // namespace

Motion makeVehicleMotion(const std::vector<VehicleLeg>& route, const VehicleMotionOptions& o,
                         const Rigid3& vehicle_from_body) {
  const Schedule schedule(route, o);
  const auto spline = [&](double spacing_s, const TimeFunction& control) {
    MotionChannel channel;
    channel.splines.push_back(motionSpline(o.duration_s, spacing_s, control));
    return channel;
  };
  MotionChannels c;
  c.east = spline(0.5, [&](double t) { return schedule.position(t).x(); });
  c.north = spline(0.5, [&](double t) { return schedule.position(t).y(); });
  c.up = spline(0.5, [&](double t) { return schedule.position(t).z(); });
  c.yaw = spline(0.5, [&](double t) { return schedule.yaw(t); });
  addTugs(o, schedule.rest_s(), c);
  addWander(o, schedule.rest_s(), c);
  return Motion(std::move(c), vehicle_from_body, o.duration_s);
}

}  // namespace lodeline
