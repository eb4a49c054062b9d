#include "lodeline/mapping/cloud/register_clouds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cstdio>
#include <limits>

#include "lodeline/diagnostics.h"
#include "lodeline/mapping/cloud/trials/test_cloud_pairs.h"

namespace lodeline {
namespace {

using test::cloudAt;
using test::Drift;
using test::PlacedCloud;
using test::Tube;
using test::TubeNoise;
using test::TubeWorld;

/// The way in and the way out past one place, and what their registration says.
struct Encounter {
  Rigid3 truth;
  CloudRegistration registration;
};

Encounter encounter(const Tube& tube, const TubeNoise& noise_in, const TubeNoise& noise_out,
                    const Drift& drift, unsigned seed, bool looks_back = true, double tilt_sigma_rad = 0.0,
                    double local_drift = 0.0) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  const TubeWorld world(tube);
  const auto random_drift = [&] {
    return Vec3(local_drift * normal(random), local_drift * normal(random),
                0.2 * local_drift * normal(random));
  };
  const Vec3 drift_in = random_drift(), drift_out = random_drift();
  const PlacedCloud in = cloudAt(world, 15.0, false, noise_in, random, drift_in);
  PlacedCloud out = cloudAt(world, 15.0 + 0.3 * normal(random), looks_back, noise_out, random, drift_out);
  const Rigid3 truth = in.world_from_frame.inverse() * out.world_from_frame;
  const Quat tilt = so3::exp(tilt_sigma_rad * Vec3(normal(random), 0.0, normal(random)));
  for (CloudPoint& point : out.cloud.points) {
    point.position_F = tilt * point.position_F;
    point.view_F = tilt * point.view_F;
    point.normal_F = tilt * point.normal_F;
  }
  return {truth, registerClouds(in.cloud, out.cloud, test::drifted(truth, drift, random),
                                test::covarianceOf(drift))};
}

Tube tubeOfSeed(unsigned seed) {
  Tube tube;
  tube.length_m = 30.0;
  tube.seed = seed;
  return tube;
}

/// How many of twelve encounters are verified; none may be wrong.
int verifiedOf(const TubeNoise& noise, const Drift& drift, bool looks_back = true) {
  int verified = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    const Encounter met = encounter(tubeOfSeed(seed), noise, noise, drift, seed, looks_back);
    if (met.registration.loop.status != LoopStatus::Verified) continue;
    ++verified;
    EXPECT_LT(test::worstError(met.registration, met.truth), 3.5) << seed;
  }
  return verified;
}

TEST(RegisterClouds, FindsTheWayInOnTheWayOut) { EXPECT_GE(verifiedOf({}, {}), 10); }

TEST(RegisterClouds, FindsThePlaceInTheSameDirection) { EXPECT_GE(verifiedOf({}, {}, false), 10); }

TEST(RegisterClouds, WorksWithFewPoints) {
  TubeNoise noise;
  noise.points_per_m = 30.0;
  EXPECT_GE(verifiedOf(noise, {}), 9);
}

TEST(RegisterClouds, SearchesAWidePrior) {
  Drift drift;
  drift.horizontal_m = 0.9;
  EXPECT_GE(verifiedOf({}, drift), 9);
}

TEST(RegisterClouds, BearsScaleOutliersAndParticles) {
  TubeNoise noise;
  noise.scale = 1.01;
  noise.outlier_share = 0.1;
  noise.particle_share = 0.05;
  EXPECT_GE(verifiedOf(noise, {}), 9);
}

TEST(RegisterClouds, FillsTheLedger) {
  const Encounter met = encounter(tubeOfSeed(4), {}, {}, {}, 4);
  const Loop& loop = met.registration.loop;
  ASSERT_EQ(loop.status, LoopStatus::Verified) << loop.reason;
  EXPECT_EQ(loop.source, "cloud");
  EXPECT_TRUE(loop.reason.empty());
  EXPECT_GT(loop.matches, 200);
  EXPECT_LE(loop.inliers, loop.matches);
  EXPECT_GT(loop.covered_share, 0.5);
  EXPECT_GT(loop.rms_sigmas, 0.2);
  EXPECT_LT(loop.mahalanobis_squared, 18.5);
  EXPECT_GE(met.registration.observed_directions, 3);
  // The covariance is that of the information, with weak knowledge elsewhere.
  const Mat6 weak = (kUnobservedFactor * test::covarianceOf({})).inverse();
  EXPECT_LT(((met.registration.information + weak) * loop.covariance - Mat6::Identity()).norm(), 1e-5);
}

TEST(RegisterClouds, ClaimsNoMoreThanItKnows) {
  // Scale, tilt and drift of each cloud have the sigmas that the registration considers.
  double sum = 0.0, most = 0.0;
  int directions = 0, verified = 0;
  for (unsigned seed = 1; seed <= 25; ++seed) {
    std::mt19937_64 random(1000 + seed);
    std::normal_distribution<double> normal;
    TubeNoise in, out;
    in.scale = 1.0 + 0.01 * normal(random);
    out.scale = 1.0 + 0.01 * normal(random);
    const Encounter met = encounter(tubeOfSeed(seed), in, out, {}, seed, true, 0.007, 0.0075);
    if (met.registration.loop.status != LoopStatus::Verified) continue;
    ++verified;
    sum += test::claimedError(met.registration, met.truth);
    directions += met.registration.observed_directions;
    most = std::max(most, test::worstError(met.registration, met.truth));
  }
  ASSERT_GE(verified, 20);
  const double nees = sum / directions;
  std::printf("%d of 25 verified, squared error by direction %.2f\n", verified, nees);
  // The bounds on scale and drift double their variances. Errors must show a part of what is claimed.
  EXPECT_GT(nees, 0.15);
  EXPECT_LT(nees, 1.2);
  EXPECT_LT(most, 3.5);
}

TEST(RegisterClouds, DoesNotCountThePrior) {
  // A prior ten times tighter does not make the measurement more certain.
  Drift tight;
  tight.horizontal_m = 0.03;
  tight.yaw_rad = 0.003;
  tight.height_m = 0.01;
  const Encounter a = encounter(tubeOfSeed(9), {}, {}, {}, 9), b = encounter(tubeOfSeed(9), {}, {}, tight, 9);
  ASSERT_EQ(a.registration.loop.status, LoopStatus::Verified) << a.registration.loop.reason;
  ASSERT_EQ(b.registration.loop.status, LoopStatus::Verified) << b.registration.loop.reason;
  EXPECT_LT((a.registration.information - b.registration.information).norm(),
            0.35 * a.registration.information.norm());
}

TEST(RegisterClouds, KnowsNothingAlongASmoothStraightPassage) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    Tube tube = tubeOfSeed(seed);
    tube.bend_rad = 0.0;
    tube.bump_m = 0.0;
    const Encounter met = encounter(tube, {}, {}, {}, seed);
    // Directions across are known to centimetres, and along not at all.
    EXPECT_EQ(met.registration.observed_directions, 3) << met.registration.loop.reason;
    EXPECT_LT(met.registration.information(2, 2), 1.0);
    EXPECT_GT(met.registration.information(0, 0), 1.0 / squared(0.05));
    // A mirrored cloud fits as well: nothing proves the place.
    EXPECT_EQ(met.registration.loop.status, LoopStatus::Refused);
    EXPECT_THAT(met.registration.loop.reason, testing::HasSubstr("mirrored"));
  }
}

TEST(RegisterClouds, KnowsOneDirectionBetweenTwoWalls) {
  Tube tube = tubeOfSeed(3);
  tube.bend_rad = 0.0;
  tube.has_two_walls = true;
  const Encounter met = encounter(tube, {}, {}, {}, 3);
  EXPECT_EQ(met.registration.observed_directions, 2) << met.registration.loop.reason;
  EXPECT_LT(met.registration.information(1, 1), 1.0);
  EXPECT_LT(met.registration.information(2, 2), 1.0);
  EXPECT_GT(met.registration.information(0, 0), 1.0 / squared(0.05));
  EXPECT_EQ(met.registration.loop.status, LoopStatus::Refused);
}

TEST(RegisterClouds, HasNoInformationBesideItsDirections) {
  for (unsigned seed = 1; seed <= 6; ++seed) {
    const Encounter met = encounter(tubeOfSeed(seed), {}, {}, {}, seed);
    const Eigen::SelfAdjointEigenSolver<Mat6> solver(met.registration.information);
    const int zeros = 6 - met.registration.observed_directions;
    EXPECT_LT(solver.eigenvalues()[zeros - 1], 1e-9 * solver.eigenvalues()[5]);
    EXPECT_GT(solver.eigenvalues()[zeros], 1e-9 * solver.eigenvalues()[5]);
  }
}

TEST(RegisterClouds, RefusesAPredictionThatIsWrong) {
  std::mt19937_64 random(5);
  const TubeWorld world(tubeOfSeed(5));
  const PlacedCloud in = cloudAt(world, 15.0, false, {}, random),
                    out = cloudAt(world, 15.0, true, {}, random);
  Rigid3 predicted = in.world_from_frame.inverse() * out.world_from_frame;
  predicted.translation.x() += 0.4;
  Drift tight;
  tight.horizontal_m = 0.04;
  const CloudRegistration result = registerClouds(in.cloud, out.cloud, predicted, test::covarianceOf(tight));
  EXPECT_EQ(result.loop.status, LoopStatus::Refused);
  EXPECT_THAT(result.loop.reason, testing::HasSubstr("contradicts the prediction"));
}

TEST(RegisterClouds, RefusesWhatItCannotSearch) {
  std::mt19937_64 random(5);
  const TubeWorld world(tubeOfSeed(5));
  const PlacedCloud in = cloudAt(world, 15.0, false, {}, random);
  Drift wide;
  wide.horizontal_m = 10.0;
  EXPECT_THAT(registerClouds(in.cloud, in.cloud, {}, test::covarianceOf(wide)).loop.reason,
              testing::HasSubstr("too uncertain"));
  EXPECT_THAT(registerClouds(in.cloud, LocalCloud{}, {}, test::covarianceOf({})).loop.reason,
              testing::HasSubstr("points"));
  Rigid3 far;
  far.translation.z() = 40.0;
  EXPECT_THAT(registerClouds(in.cloud, in.cloud, far, test::covarianceOf({})).loop.reason,
              testing::HasSubstr("do not overlap"));
  const Rigid3 leaning(so3::exp(Vec3(0.2, 0.0, 0.0)), Vec3::Zero());
  EXPECT_THAT(registerClouds(in.cloud, in.cloud, leaning, test::covarianceOf({})).loop.reason,
              testing::HasSubstr("gravity"));
}

TEST(RegisterClouds, IsTheSameEveryTime) {
  const Encounter a = encounter(tubeOfSeed(8), {}, {}, {}, 8), b = encounter(tubeOfSeed(8), {}, {}, {}, 8);
  EXPECT_EQ(a.registration.loop.old_from_new.translation, b.registration.loop.old_from_new.translation);
  EXPECT_EQ(a.registration.information, b.registration.information);
}

TEST(RegisterClouds, RefusesBadInput) {
  const LocalCloud cloud;
  Mat6 covariance = Mat6::Identity();
  Rigid3 lost;
  lost.translation.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(registerClouds(cloud, cloud, lost, covariance), InputError);
  covariance(0, 0) = -1.0;
  EXPECT_THROW(registerClouds(cloud, cloud, {}, covariance), InputError);
  CloudRegistrationOptions options;
  options.neighbours = 2;
  EXPECT_THROW(registerClouds(cloud, cloud, {}, Mat6::Identity(), options), UsageError);
  options = {};
  options.most_usual_error = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(registerClouds(cloud, cloud, {}, Mat6::Identity(), options), UsageError);
}

}  // namespace
}  // namespace lodeline
