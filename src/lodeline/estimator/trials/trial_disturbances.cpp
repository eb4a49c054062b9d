#include "lodeline/estimator/trials/trial_disturbances.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lodeline/util/angles.h"
#include "simulation/shared/random.h"

namespace lodeline {
namespace {

/// The greatest turn of a compass on the way by one dipole, rad.
double greatestTurn(const Motion& motion, const Vec3& field_W, const LyingDipole& dipole, double end_s) {
  double greatest = 0.0;
  for (double t = 0.0; t < end_s; t += 1.0) {
    const Vec3 field = fieldOfDipoles({dipole}, motion.at(t).world_from_body.translation);
    greatest = std::max(greatest, std::abs(headingDeflection(field_W, field)));
  }
  return greatest;
}

/// The dipole with the moment that turns the compass by `wanted_rad` at most.
LyingDipole scaledTo(double wanted_rad, const Motion& motion, const Vec3& field_W, LyingDipole dipole,
                     double end_s) {
  const Vec3 direction = dipole.moment_W;
  double low = 0.0, high = 1000.0;
  for (int i = 0; i < 30; ++i) {
    const double middle = 0.5 * (low + high);
    dipole.moment_W = middle * direction;
    (greatestTurn(motion, field_W, dipole, end_s) < wanted_rad ? low : high) = middle;
  }
  return dipole;
}

}  // namespace

std::vector<LyingDipole> drawDipolesBeside(const Motion& motion, const Vec3& field_W, double spacing_m,
                                           uint64_t seed) {
  Random random(seed, "trial/dipoles beside");
  std::vector<LyingDipole> dipoles;
  double next_m = 4.0, way_m = 0.0;
  const double half_s = 0.5 * motion.duration_s();
  Vec3 before_W = motion.at(0.0).world_from_body.translation;
  for (double t = 0.0; t < half_s; t += 0.5) {
    const Vec3 here_W = motion.at(t).world_from_body.translation;
    way_m += (here_W - before_W).norm();
    before_W = here_W;
    if (way_m < next_m) continue;
    next_m += spacing_m * random.uniform(0.6, 1.4);
    const double aside_rad = random.uniform(0.0, 2.0 * std::numbers::pi);
    LyingDipole dipole;
    dipole.position_W =
        here_W + random.uniform(1.0, 2.0) * Vec3(std::cos(aside_rad), std::sin(aside_rad), -0.5);
    dipole.moment_W = (field_W.normalized() + 0.8 * random.normal3()).normalized();
    dipoles.push_back(scaledTo(random.uniform(12.0, 30.0) * kDegree, motion, field_W, dipole, half_s));
  }
  return dipoles;
}

std::vector<LyingDipole> drawIronAtStart(const Motion& motion, const Vec3& field_W, uint64_t seed) {
  Random random(seed, "trial/iron at start");
  const double aside_rad = random.uniform(0.0, 2.0 * std::numbers::pi);
  LyingDipole dipole;
  dipole.position_W = motion.at(0.0).world_from_body.translation +
                      random.uniform(1.0, 2.0) * Vec3(std::cos(aside_rad), std::sin(aside_rad), -0.5);
  dipole.moment_W = (field_W.normalized() + 0.8 * random.normal3()).normalized();
  return {scaledTo(random.uniform(6.0, 20.0) * kDegree, motion, field_W, dipole, 4.0)};
}

std::vector<LyingDipole> drawMagnetite(const Centerline& passage, const Vec3& field_W, uint64_t seed) {
  Random random(seed, "trial/magnetite");
  constexpr double kOnAMetre = 8.0;
  std::vector<LyingDipole> dipoles;
  const double begin_m = passage.beginArcLength(), end_m = passage.endArcLength();
  const int count = static_cast<int>(kOnAMetre * (end_m - begin_m));
  for (int i = 0; i < count; ++i) {
    const PassageStation station = passage.at(random.uniform(begin_m, end_m));
    const Vec3 right_W = station.tangent_W.cross(Vec3::UnitZ()).normalized();
    const double around_rad = random.uniform(0.0, 2.0 * std::numbers::pi);
    const Vec3 wall_W =
        station.position_W + 1.1 * (0.5 * station.width_m * std::cos(around_rad) * right_W +
                                    0.5 * station.height_m * std::sin(around_rad) * Vec3::UnitZ());
    const Vec3 moment_W = 4.0 * field_W.normalized() + 12.0 * random.normal3();
    dipoles.push_back({wall_W, moment_W});
  }
  return dipoles;
}

}  // namespace lodeline
