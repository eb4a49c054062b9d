// Pairs of rays of two cameras behind ports.

#include <gtest/gtest.h>

#include <cmath>

#include "lodeline/cameras/test_camera_models.h"
#include "lodeline/frontend/stereo/stereo_matcher.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

std::shared_ptr<const Camera> behindPlate(const Vec3& normal, double distance_m) {
  CameraCalibration c = test::typicalCamera(*findCameraModel("radial-tangential"), 4);
  c.port = Port{.normal_C = normal.normalized(), .distance_m = distance_m, .thickness_m = 0.008};
  return makeCamera(c);
}

class PortRays : public testing::Test {
 protected:
  RayPair raysOf(const Vec3& first_point, bool with_lines) const {
    const Vec2 in_first = *first_->project(first_point);
    const Vec2 in_second = *second_->project(second_from_first_ * first_point);
    if (with_lines) return rayPair(*first_->viewRay(in_first), *second_->viewRay(in_second));
    return {*first_->unproject(in_first), *second_->unproject(in_second)};
  }
  double offPlane(const RayPair& rays) const {
    return std::abs(epipolarNormal(rays.betweenOrigins(second_from_first_), rays.first)->dot(rays.second));
  }

  std::shared_ptr<const Camera> first_ = behindPlate(Vec3(0.03, 0.02, 1.0), 0.03);
  std::shared_ptr<const Camera> second_ = behindPlate(Vec3(-0.03, -0.01, 1.0), 0.02);
  Rigid3 second_from_first_{so3::exp(Vec3(0.01, -0.02, 0.015)), Vec3(-0.11, 0.002, 0.001)};
};

TEST_F(PortRays, LieInOnePlaneAtEveryDistance) {
  double worst_of_directions = 0.0;
  for (const double range_m : {0.3, 1.0, 4.0, 25.0}) {
    for (double x = -0.4; x < 0.41; x += 0.1) {
      const Vec3 point = range_m * Vec3(x, 0.2 - 0.5 * x, 1.0);
      EXPECT_LT(offPlane(raysOf(point, true)), 1e-12) << range_m;
      worst_of_directions = std::max(worst_of_directions, offPlane(raysOf(point, false)));
    }
  }
  EXPECT_GT(worst_of_directions, 5e-4) << "directions alone miss each other";
}

TEST_F(PortRays, AreThoseOfTheLensesWithoutPorts) {
  const RayPair rays{Vec3::UnitZ(), Vec3(0.1, 0.0, 1.0).normalized()};
  const Rigid3 between = rays.betweenOrigins(second_from_first_);
  EXPECT_EQ(between.translation, second_from_first_.translation);
  EXPECT_EQ(between.rotation.coeffs(), second_from_first_.rotation.coeffs());
}

}  // namespace
}  // namespace lodeline
