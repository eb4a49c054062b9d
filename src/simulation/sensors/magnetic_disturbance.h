#pragma once

#include <functional>
#include <vector>

#include "simulation/shared/motion.h"

namespace lodeline {

/// Field of a magnetic dipole, T, at an offset (m) from it. `moment` in A m^2, same axes.
Vec3 dipoleField(const Vec3& moment, const Vec3& offset);

/// Iron in the passage: a tank, an anchor, a line marker's spike.
struct LyingDipole {
  Vec3 position_W = Vec3::Zero();
  Vec3 moment_W = Vec3::Zero();  ///< A m^2
};

/// Sum of their fields at a point, T.
Vec3 fieldOfDipoles(const std::vector<LyingDipole>& dipoles, const Vec3& point_W);

/// Iron that approaches and leaves: a companion's steel tank. Its position is constant in the diver frame.
/// Its magnetization, induced by the Earth's field, has a constant direction in the world.
struct PassingIron {
  double begin_s = 0.0;
  double duration_s = 0.0;  ///< time at full strength; increase and decrease take `ramp_s` each
  double ramp_s = 3.0;
  Vec3 position_B = Vec3::Zero();
  Vec3 moment_W = Vec3::Zero();
};

/// A switched current: field of the lamp's cable at the sensor.
struct SwitchedCurrent {
  double begin_s = 0.0;
  double duration_s = 0.0;
  Vec3 field_B = Vec3::Zero();  ///< T
};

/// A slowly varying field in the world frame from rock and nearby objects: samples of a random process with
/// linear interpolation; constant before and after.
struct WanderingField {
  double interval_s = 1.0;
  std::vector<Vec3> field_W;  ///< T

  Vec3 at(double time_s) const;
};

/// External fields at the magnetometer except the Earth's.
struct MagneticDisturbances {
  std::vector<LyingDipole> lying;
  std::vector<PassingIron> passing;
  std::vector<SwitchedCurrent> switched;
  WanderingField wandering = {};
  std::vector<LyingDipole> steel = {};  ///< of a wreck's hull
  /// Field of the vehicle's own currents in axes of the readings, T; it adds to the readings. Empty: none.
  std::function<Vec3(double time_s)> currents_M = {};

  /// Sum of the fields except `currents_M` at the body's origin in world axes, T.
  Vec3 at(const Rigid3& world_from_body, double time_s) const;
};

/// Heading error of a horizontal compass caused by the disturbance, rad.
double headingDeflection(const Vec3& field_W, const Vec3& disturbance_W);

struct DisturbanceOptions {
  uint64_t seed = 1;
  double mean_interval_s = 150.0;  ///< between events
  double least_deflection_rad = 0.035;
  double most_deflection_rad = 0.175;
  double shortest_s = 10.0;
  double longest_s = 30.0;
};

/// Draws iron along a dive: alternately a companion's tank and a dipole beside the path. Each causes a
/// maximum heading error of 2 to 10 degrees. There is none in the first and last 20 s.
MagneticDisturbances drawDisturbances(const Motion& motion, const Vec3& field_W,
                                      const DisturbanceOptions& options);

/// Draws the switching (or dimming) of the lamp every few minutes, with 0.1 to 0.4 uT at the sensor. The
/// first one is within 90 s after `earliest_s`.
std::vector<SwitchedCurrent> drawLampSwitching(double duration_s, uint64_t seed, double earliest_s = 30.0);

/// Draws a stationary Gauss-Markov process with this sigma per axis, whose correlation decays to 1/e within
/// `correlation_s`.
WanderingField drawWanderingField(double duration_s, double sigma_T, double correlation_s, uint64_t seed);

}  // namespace lodeline
