#include "simulation/vehicle/hull_steel.h"

#include "simulation/rendering/cave/wreck_mesh.h"
#include "simulation/shared/random.h"

namespace lodeline {

std::vector<LyingDipole> drawHullSteel(const WreckLayout& wreck, const Vec3& field_W, uint64_t seed) {
  Random random(seed, "wreck/steel");
  const Quat heading(Eigen::AngleAxisd(wreck.azimuth_rad, Vec3::UnitZ()));
  HullShape hull;
  hull.half_length_m = static_cast<float>(0.5 * wreck.length_m);
  hull.half_beam_m = static_cast<float>(0.5 * wreck.width_m);
  hull.depth_m = static_cast<float>(wreck.height_m);
  const Vec3 induced_direction = field_W.normalized();
  // The ship lay in one direction while it was built.
  const Vec3 permanent_direction = (heading * Vec3::UnitX() + 0.4 * random.normal3()).normalized();
  std::vector<LyingDipole> steel;
  constexpr double kSpacing_m = 2.0;
  const int along = static_cast<int>(wreck.length_m / kSpacing_m);
  const int around = static_cast<int>((wreck.width_m + 2.0 * wreck.height_m) / kSpacing_m);
  for (int i = 0; i < along; ++i) {
    for (int j = 0; j < around; ++j) {
      const Vec3 place = hull.point((static_cast<float>(i) + 0.5f) / static_cast<float>(along),
                                    (static_cast<float>(j) + 0.5f) / static_cast<float>(around))
                             .cast<double>();
      const double induced = random.uniform(150.0, 450.0);
      const double permanent = 300.0 * random.normal();
      const Vec3 moment_W =
          induced * induced_direction + permanent * permanent_direction + 150.0 * random.normal3();
      steel.push_back({wreck.center_W + heading * place, moment_W});
    }
  }
  constexpr double kPlateLength_m = 8.0, kPlateWidth_m = 6.0, kPlateStep_m = 0.5;
  const Vec3 plate_moment_W = random.uniform(80.0, 120.0) * (heading * random.direction());
  for (double x = 0.0; x <= kPlateLength_m; x += kPlateStep_m) {
    for (double y = -0.5 * kPlateWidth_m; y <= 0.5 * kPlateWidth_m; y += kPlateStep_m) {
      const Vec3 place(x - 0.40 * wreck.length_m, y, wreck.height_m - 1.2);
      steel.push_back({wreck.center_W + heading * place, plate_moment_W});
    }
  }
  return steel;
}

}  // namespace lodeline
