#include "simulation/motion/vehicle_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

const Rigid3 kVehicleFromBody(so3::exp(Vec3(0.02, -0.01, 0.03)), Vec3(0.02, -0.01, 0.03));

double hills(double east_m, double north_m) {
  return 0.6 * std::sin(0.2 * east_m) * std::cos(0.15 * north_m);
}

VehicleMotionOptions vehicleOptions(double duration_s, uint64_t seed = 1) {
  VehicleMotionOptions o;
  o.duration_s = duration_s;
  o.seed = seed;
  return o;
}

TEST(VehicleMotion, TransectsAreAsLongAsAskedAndStayAtTheirAltitude) {
  for (const double length_m : {20.0, 60.0, 300.0}) {
    for (uint64_t seed = 1; seed <= 2; ++seed) {
      const double duration_s = length_m / 0.385;
      const Motion motion =
          makeTransectMotion(hills, 2.0, length_m, vehicleOptions(duration_s, seed), kVehicleFromBody);
      EXPECT_NEAR(pathLength(motion, 0.0, duration_s), length_m, 0.02 * length_m);
      double squares = 0.0, worst_m = 0.0;
      int count = 0;
      for (double t = 10.0; t < duration_s; t += 0.5, ++count) {
        const Vec3 place = motion.at(t).world_from_body.translation - motion.worldShift();
        const double off_m = place.z() - hills(place.x(), place.y()) - 2.0;
        squares += off_m * off_m;
        worst_m = std::max(worst_m, std::abs(off_m));
      }
      EXPECT_LT(std::sqrt(squares / count), 0.06);
      EXPECT_LT(worst_m, 0.25);
    }
  }
}

TEST(VehicleMotion, LooksAlongItsTransectsAndCoversTheAreaBetweenThem) {
  const Motion motion = makeTransectMotion(hills, 2.0, 300.0, vehicleOptions(780.0), Rigid3());
  int aligned = 0, moving = 0;
  for (double t = 10.0; t < 770.0; t += 0.5) {
    const MotionState state = motion.at(t);
    const Vec3 velocity_D = state.world_from_body.rotation.conjugate() * state.velocity_W;
    if (velocity_D.norm() < 0.3) continue;
    ++moving;
    aligned += velocity_D.x() > 0.9 * velocity_D.norm();
  }
  EXPECT_GT(moving, 900);
  EXPECT_GT(aligned, 0.9 * moving);
}

TEST(VehicleMotion, TugsAreShortAndRestIsStill) {
  const Motion motion = makeTransectMotion(hills, 2.0, 120.0, vehicleOptions(310.0), Rigid3());
  for (double t = 0.0; t < 3.0; t += 0.1) EXPECT_LT(motion.at(t).velocity_W.norm(), 1e-3) << t;
  // Accelerations above those of the route and its controller come in bursts.
  int bursts = 0;
  double since_s = -100.0, greatest = 0.0;
  for (double t = 5.0; t < 300.0; t += 0.02) {
    const double acceleration = motion.at(t).acceleration_W.norm();
    greatest = std::max(greatest, acceleration);
    if (acceleration < 0.8) continue;
    if (t - since_s > 5.0) ++bursts;
    since_s = t;
  }
  EXPECT_GE(bursts, 3);
  EXPECT_LE(bursts, 14);
  EXPECT_LT(greatest, 4.0);
}

TEST(VehicleMotion, LapsLeadAroundAndThroughTheHull) {
  WreckLayout wreck;
  wreck.length_m = 40.0;
  wreck.width_m = 12.0;
  wreck.azimuth_rad = 0.7;
  const double length_m = wreckLapLength_m(wreck, 2);
  const Motion motion = makeWreckLapMotion(wreck, 2, length_m, vehicleOptions(length_m / 0.42), Rigid3());
  EXPECT_NEAR(pathLength(motion, 0.0, motion.duration_s()), length_m, 0.02 * length_m);
  int inside = 0, passages = 0;
  bool was_inside = false;
  double farthest_m = 0.0, turned = 0.0, last_angle = 0.0;
  const Quat wreck_from_world(Eigen::AngleAxisd(-wreck.azimuth_rad, Vec3::UnitZ()));
  for (double t = 0.0; t < motion.duration_s(); t += 0.5) {
    const Vec3 place =
        wreck_from_world * (motion.at(t).world_from_body.translation - motion.worldShift() - wreck.center_W);
    const bool is_inside = std::abs(place.x()) < 18.0 && std::abs(place.y()) < 2.0;
    inside += is_inside;
    passages += is_inside && !was_inside;
    was_inside = is_inside;
    farthest_m = std::max(farthest_m, place.head<2>().norm());
    const double angle = std::atan2(place.y(), place.x());
    if (!is_inside && t > 0.0) turned += std::remainder(angle - last_angle, 2.0 * M_PI);
    last_angle = angle;
    // Outside, the vehicle keeps away from the sides.
    if (!is_inside && std::abs(place.x()) < 15.0) {
      EXPECT_GT(std::abs(place.y()), 7.0) << t;
    }
  }
  EXPECT_EQ(passages, 2);
  EXPECT_GT(inside, 100);
  EXPECT_GT(farthest_m, 36.0);
  EXPECT_NEAR(turned, 4.0 * M_PI, 0.6);  // two rounds
}

TEST(VehicleMotion, DerivativesAgreeWithNumericOnes) {
  const Motion motion = makeTransectMotion(hills, 2.0, 60.0, vehicleOptions(156.0), kVehicleFromBody);
  constexpr double kStep_s = 1e-4;
  for (double t = 0.3; t < 155.0; t += 1.37) {
    const MotionState before = motion.at(t - kStep_s), now = motion.at(t), after = motion.at(t + kStep_s);
    EXPECT_LT((now.acceleration_W - (after.velocity_W - before.velocity_W) / (2.0 * kStep_s)).norm(), 1e-5);
  }
}

TEST(VehicleMotion, RefusesSpeedsThatNoVehicleHas) {
  EXPECT_THROW(makeTransectMotion(hills, 2.0, 300.0, vehicleOptions(60.0), Rigid3()), UsageError);
  EXPECT_THROW(makeTransectMotion(hills, 2.0, 3.0, vehicleOptions(600.0), Rigid3()), UsageError);
}

}  // namespace
}  // namespace lodeline
