#include "simulation/sensors/magnetic_disturbance.h"

#include <algorithm>
#include <cmath>

#include "simulation/shared/random.h"

namespace lodeline {
namespace {

double smoothStep01(double u) {
  u = std::clamp(u, 0.0, 1.0);
  return u * u * (3.0 - 2.0 * u);
}

double strength(const PassingIron& iron, double time_s) {
  const double coming = smoothStep01((time_s - iron.begin_s + iron.ramp_s) / iron.ramp_s);
  const double going = smoothStep01((time_s - iron.begin_s - iron.duration_s) / iron.ramp_s);
  return coming * (1.0 - going);
}

// Scales a moment by bisection until the maximum heading error over [begin, end] is the wanted one. The
// heading error increases with the moment while it is far from 90 degrees.
template <typename FieldAt>
double momentScale(const Motion& motion, const Vec3& field_W, double begin_s, double end_s, double wanted_rad,
                   const FieldAt& fieldAt) {
  std::vector<Vec3> unit;
  for (double t = begin_s; t <= end_s; t += 0.5) unit.push_back(fieldAt(motion.at(t).world_from_body, t));
  double low = 0.0, high = 400.0;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    double worst = 0.0;
    for (const Vec3& f : unit) worst = std::max(worst, std::abs(headingDeflection(field_W, middle * f)));
    (worst < wanted_rad ? low : high) = middle;
  }
  return low;
}

// A direction within about 40 degrees of the Earth's field: magnetization is mostly induced.
Vec3 inducedDirection(const Vec3& field_W, Random& random) {
  return (field_W.normalized() + 0.6 * random.normal3()).normalized();
}

void addDipoles(const std::vector<LyingDipole>& dipoles, const Vec3& point_W, Vec3* sum) {
  for (const LyingDipole& d : dipoles) *sum += dipoleField(d.moment_W, point_W - d.position_W);
}

}  // namespace

Vec3 dipoleField(const Vec3& moment, const Vec3& offset) {
  constexpr double kMu0Over4Pi = 1e-7;  // T m / A
  const double r = std::max(offset.norm(), 0.05);
  const Vec3 direction = offset / r;
  return kMu0Over4Pi / (r * r * r) * (3.0 * direction * direction.dot(moment) - moment);
}

Vec3 fieldOfDipoles(const std::vector<LyingDipole>& dipoles, const Vec3& point_W) {
  Vec3 sum = Vec3::Zero();
  addDipoles(dipoles, point_W, &sum);
  return sum;
}

Vec3 WanderingField::at(double time_s) const {
  if (field_W.empty()) return Vec3::Zero();
  const double last = static_cast<double>(field_W.size()) - 1.0;
  const double position = std::clamp(time_s / interval_s, 0.0, last);
  const auto before = static_cast<size_t>(position);
  const size_t after = std::min(before + 1, field_W.size() - 1);
  const double share = position - static_cast<double>(before);
  return (1.0 - share) * field_W[before] + share * field_W[after];
}

Vec3 MagneticDisturbances::at(const Rigid3& world_from_body, double time_s) const {
  Vec3 sum = wandering.at(time_s);
  addDipoles(lying, world_from_body.translation, &sum);
  addDipoles(steel, world_from_body.translation, &sum);
  for (const PassingIron& iron : passing) {
    const double share = strength(iron, time_s);
    if (share > 0.0) sum += share * dipoleField(iron.moment_W, -(world_from_body.rotation * iron.position_B));
  }
  for (const SwitchedCurrent& s : switched) {
    if (time_s >= s.begin_s && time_s < s.begin_s + s.duration_s) sum += world_from_body.rotation * s.field_B;
  }
  return sum;
}

double headingDeflection(const Vec3& field_W, const Vec3& disturbance_W) {
  const Vec3 sum = field_W + disturbance_W;
  return std::remainder(std::atan2(sum.y(), sum.x()) - std::atan2(field_W.y(), field_W.x()), 2.0 * M_PI);
}

MagneticDisturbances drawDisturbances(const Motion& motion, const Vec3& field_W,
                                      const DisturbanceOptions& o) {
  Random random(o.seed, "magnetic/events");
  MagneticDisturbances disturbances;
  constexpr double kQuiet_s = 20.0;
  double t = kQuiet_s + o.mean_interval_s * random.uniform(0.2, 0.6);
  for (int i = 0;; ++i) {
    const double duration_s = random.uniform(o.shortest_s, o.longest_s);
    const double wanted = random.uniform(o.least_deflection_rad, o.most_deflection_rad);
    const Vec3 direction = inducedDirection(field_W, random);
    const Vec3 aside = random.direction();
    const double interval_s = o.mean_interval_s * random.uniform(0.6, 1.4);
    if (t + duration_s > motion.duration_s() - kQuiet_s) return disturbances;
    if (i % 2 == 0) {
      PassingIron iron;
      iron.ramp_s = std::min(3.0, 0.25 * duration_s);
      iron.begin_s = t + iron.ramp_s;
      iron.duration_s = duration_s - 2.0 * iron.ramp_s;
      iron.position_B = 0.9 * aside;
      iron.moment_W = direction;
      MagneticDisturbances one;
      one.passing = {iron};
      iron.moment_W *= momentScale(motion, field_W, t, t + duration_s, wanted,
                                   [&](const Rigid3& pose, double time_s) { return one.at(pose, time_s); });
      disturbances.passing.push_back(iron);
    } else {
      LyingDipole dipole;
      // On the floor beside the position of the diver in the middle of the event.
      dipole.position_W = motion.at(t + 0.5 * duration_s).world_from_body.translation +
                          Vec3(0.8 * aside.x(), 0.8 * aside.y(), -0.9);
      // The way back passes it again, so the maximum is over the whole dive.
      dipole.moment_W =
          direction *
          momentScale(motion, field_W, 0.0, motion.duration_s(), wanted, [&](const Rigid3& pose, double) {
            return dipoleField(direction, pose.translation - dipole.position_W);
          });
      disturbances.lying.push_back(dipole);
    }
    t += duration_s + interval_s;
  }
}

WanderingField drawWanderingField(double duration_s, double sigma_T, double correlation_s, uint64_t seed) {
  Random random(seed, "magnetic/wandering");
  WanderingField field;
  field.interval_s = 0.2 * correlation_s;
  const double kept = std::exp(-field.interval_s / correlation_s);
  Vec3 now = sigma_T * random.normal3();
  for (double t = 0.0; t < duration_s + field.interval_s; t += field.interval_s) {
    field.field_W.push_back(now);
    now = kept * now + std::sqrt(1.0 - kept * kept) * sigma_T * random.normal3();
  }
  return field;
}

std::vector<SwitchedCurrent> drawLampSwitching(double duration_s, uint64_t seed, double earliest_s) {
  Random random(seed, "magnetic/lamp");
  std::vector<SwitchedCurrent> switched;
  const Vec3 cable_B = random.direction();
  double t = random.uniform(earliest_s, earliest_s + 90.0);
  while (t < duration_s) {
    const double on_s = random.uniform(20.0, 200.0);
    switched.push_back({t, on_s, random.uniform(0.1e-6, 0.4e-6) * cable_B});
    t += on_s + random.uniform(60.0, 300.0);
  }
  return switched;
}

}  // namespace lodeline
