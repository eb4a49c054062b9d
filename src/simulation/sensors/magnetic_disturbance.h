#pragma once

#include <vector>

#include "simulation/shared/motion.h"

namespace lodeline {

/// Field of a magnetic dipole, T, at an offset (m) from it. `moment` in A m^2, same axes.
Vec3 dipoleField(const Vec3& moment, const Vec3& offset);

/// Iron that lies in the passage: a tank, an anchor, a line marker's spike.
struct LyingDipole {
  Vec3 position_W = Vec3::Zero();
  Vec3 moment_W = Vec3::Zero();  ///< A m^2
};

/// Iron that comes near and goes away: a companion's steel tank. It keeps its place in the diver frame, while
/// its magnetization, induced by the Earth's field, keeps its direction in the world.
struct PassingIron {
  double begin_s = 0.0;
  double duration_s = 0.0;  ///< at full strength; coming and going take `ramp_s` each
  double ramp_s = 3.0;
  Vec3 position_B = Vec3::Zero();
  Vec3 moment_W = Vec3::Zero();
};

/// A current that is switched: the field of the lamp's cable at the sensor.
struct SwitchedCurrent {
  double begin_s = 0.0;
  double duration_s = 0.0;
  Vec3 field_B = Vec3::Zero();  ///< T
};

/// A field of the world that is hardly the same from one moment to the next: rock, what lies about. Samples
/// of a process, straight lines between them; constant before and after.
struct WanderingField {
  double interval_s = 1.0;
  std::vector<Vec3> field_W;  ///< T

  Vec3 at(double time_s) const;
};

/// What else than the Earth acts on the magnetometer from outside.
struct MagneticDisturbances {
  std::vector<LyingDipole> lying;
  std::vector<PassingIron> passing;
  std::vector<SwitchedCurrent> switched;
  WanderingField wandering = {};

  /// Sum in world axes, T, at the body's origin.
  Vec3 at(const Rigid3& world_from_body, double time_s) const;
};

/// The angle by which a disturbance turns the heading of a horizontal compass, rad.
double headingDeflection(const Vec3& field_W, const Vec3& disturbance_W);

struct DisturbanceOptions {
  uint64_t seed = 1;
  double mean_interval_s = 150.0;  ///< between events
  double least_deflection_rad = 0.035;
  double most_deflection_rad = 0.175;
  double shortest_s = 10.0;
  double longest_s = 30.0;
};

/// Iron along a dive: by turns a companion's tank and a dipole beside the path, each strong enough to turn
/// the heading by 2 to 10 degrees at its worst. The first and last 20 s stay quiet.
MagneticDisturbances drawDisturbances(const Motion& motion, const Vec3& field_W,
                                      const DisturbanceOptions& options);

/// The lamp switched off and on again (or dimmed) every few minutes, with 0.1 to 0.4 uT at the sensor; first
/// within 90 s from `earliest_s` on.
std::vector<SwitchedCurrent> drawLampSwitching(double duration_s, uint64_t seed, double earliest_s = 30.0);

/// A stationary Gauss-Markov process of this sigma an axis, whose correlation falls to 1/e within
/// `correlation_s`.
WanderingField drawWanderingField(double duration_s, double sigma_T, double correlation_s, uint64_t seed);

}  // namespace lodeline
