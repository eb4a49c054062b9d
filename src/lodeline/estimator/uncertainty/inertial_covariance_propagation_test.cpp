#include "lodeline/estimator/uncertainty/inertial_covariance_propagation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "lodeline/estimator/estimator.h"
#include "lodeline/estimator/trials/scene.h"

namespace lodeline {
namespace {

constexpr double kLight_s = 8.0, kDark_s = 300.0;

struct Claim {
  double time_s, position_m, heading_rad;
};

/// Reported horizontal sigmas of every frame of a scene whose images end after kLight_s.
std::vector<Claim> claimsInTheDark() {
  TestSceneOptions options;
  options.cameras = 2;
  options.duration_s = kLight_s + kDark_s;
  options.points.frame_rate_hz = 5.0;
  TestScene scene(options);
  Diagnostics diagnostics;
  Estimator estimator(scene.rig(), honestOptions(options), &diagnostics);
  std::vector<Claim> claims;
  std::optional<Time> start;
  while (auto frame = scene.next()) {
    start = start.value_or(frame->tracks.time);
    const double time_s = (frame->tracks.time - *start).seconds();
    if (time_s > kLight_s) frame->tracks.observations.clear();
    const FrameEstimate estimate = estimator.add(frame->tracks, frame->imu);
    if (estimate.status != Status::Inertial) continue;
    claims.push_back({time_s - kLight_s, std::sqrt(estimate.covariance.topLeftCorner<2, 2>().trace()),
                      std::sqrt(estimate.covariance(5, 5))});
  }
  return claims;
}

TEST(InertialCovariancePropagation, ClaimsLessAndLess) {
  const std::vector<Claim> claims = claimsInTheDark();
  ASSERT_GT(claims.size(), 1000u);
  const auto at = [&](double time_s) {
    return *std::find_if(claims.begin(), claims.end(), [&](const Claim& c) { return c.time_s > time_s; });
  };
  // The position error grows with the square of time by a wrong tilt and with its cube by a gyroscope bias.
  // The window's own covariance is random once its digits are exhausted.
  for (const double time_s : {30.0, 60.0, 120.0}) {
    const double growth = at(2.0 * time_s).position_m / at(time_s).position_m;
    EXPECT_GT(growth, 3.0) << time_s << " s";
    EXPECT_LT(growth, 20.0) << time_s << " s";
  }
  for (const Claim& claim : claims) EXPECT_TRUE(std::isfinite(claim.position_m)) << claim.time_s << " s";
  EXPECT_GT(at(280.0).heading_rad, 1.5 * at(60.0).heading_rad);
}

}  // namespace
}  // namespace lodeline
