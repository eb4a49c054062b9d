#pragma once

#include <numbers>

#include "lodeline/output/survey/map/dive_map.h"

/// A synthetic dive for the tests in this folder.
namespace lodeline::test {

/// Florida, 1.6 degrees west of the central meridian of its grid: convergence -0.80 degrees.
inline const GeodeticPosition kDevilsEye = {29.83, -82.60, 10.0};

/// Position of a diver on a winding path downwards through a passage after (about) `s` metres.
inline Vec3 wayAt(double s) {
  return {0.8 * s, 6.0 * std::sin(s / 15.0), -0.15 * s + 0.5 * std::cos(s / 6.0) - 0.5};
}

/// Poses at intervals of 0.2 m along that path for `length_m`, at 5 Hz, with walls at a distance of 2 m: a
/// round passage.
inline RunFolder windingDive(double length_m = 120.0) {
  RunFolder run;
  run.folder = "winding";
  run.trajectory_file = "trajectory.tum";
  run.heading_reference = HeadingReference::True;
  const auto count = static_cast<int>(length_m / 0.2);
  for (int i = 0; i <= count; ++i) {
    const double s = 0.2 * i;
    const Time time = Time::fromNanoseconds(1795255200000000000 + 200000000LL * i);
    const Quat rotation(Eigen::AngleAxisd(0.02 * s, Vec3(0.2, 0.1, 1.0).normalized()));
    run.trajectory.poses.push_back({time, Rigid3(rotation, wayAt(s))});
    run.uncertainties.push_back({time, Vec3(1e-4, 2e-4, 1e-5).asDiagonal() * Mat3::Identity() * s});
    const Vec3 along = (wayAt(s + 0.01) - wayAt(s)).normalized();
    const Vec3 left = Vec3::UnitZ().cross(along).normalized();
    for (int k = 0; k < 24; ++k) {
      const double angle = 2.0 * std::numbers::pi * (k + 0.37 * (i % 3)) / 24.0;
      const Vec3 wall = wayAt(s) + 2.0 * (std::cos(angle) * left + std::sin(angle) * along.cross(left));
      run.landmarks.push_back({wall, 5});
    }
  }
  return run;
}

}  // namespace lodeline::test
