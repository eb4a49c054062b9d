#include "simulation/shared/motion.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "lodeline/geometry/so3.h"
#include "lodeline/imu/preintegration.h"
#include "simulation/motion/dive_motion.h"

namespace lodeline {
namespace {

const Rigid3 kDiverFromBody(so3::exp(Vec3(0.4, -1.1, 1.9)), Vec3(0.05, -0.08, 0.03));
const Vec3 kGravity(0.0, 0.0, -9.80665);

Motion dive(uint64_t seed, DiveMotionOptions options = {}) {
  CenterlineOptions passage;
  passage.seed = seed;
  options.seed = seed;
  passage.length_m = 0.5 * options.path_length_m;
  return makeDiveMotion(Centerline::generate(passage), options, kDiverFromBody);
}

DiveMotionOptions shortDive() {
  DiveMotionOptions options;
  options.duration_s = 100.0;
  options.path_length_m = 20.0;
  return options;
}

TEST(Motion, DerivativesAgreeWithNumericOnes) {
  const Motion motion = dive(1, shortDive());
  constexpr double kStep = 1e-4;
  for (double t = 0.3; t < 100.0; t += 1.37) {
    const MotionState before = motion.at(t - kStep), now = motion.at(t), after = motion.at(t + kStep);
    EXPECT_LT((now.velocity_W -
               (after.world_from_body.translation - before.world_from_body.translation) / (2.0 * kStep))
                  .norm(),
              1e-6);
    EXPECT_LT((now.acceleration_W - (after.velocity_W - before.velocity_W) / (2.0 * kStep)).norm(), 1e-5);
    const Vec3 turned =
        so3::log(before.world_from_body.rotation.conjugate() * after.world_from_body.rotation);
    EXPECT_LT((now.angular_velocity_B - turned / (2.0 * kStep)).norm(), 1e-6);
    EXPECT_LT(
        (now.angular_acceleration_B - (after.angular_velocity_B - before.angular_velocity_B) / (2.0 * kStep))
            .norm(),
        1e-4);
  }
}

TEST(Motion, SnapHasNoJumps) {
  const Motion motion = dive(2, shortDive());
  const auto snap = [&](double t) -> Vec3 {
    constexpr double kStep = 1e-3;
    return (motion.at(t + kStep).acceleration_W - 2.0 * motion.at(t).acceleration_W +
            motion.at(t - kStep).acceleration_W) /
           (kStep * kStep);
  };
  // At any time, knots included, the change over 8 ms is within the limit of a continuous function; a step
  // would keep its size for smaller steps.
  double largest = 0.0, largest_change = 0.0, largest_half_change = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const double t = 20.0 + 0.004 * i;
    largest = std::max(largest, snap(t).norm());
    largest_change = std::max(largest_change, (snap(t + 0.008) - snap(t)).norm());
    largest_half_change = std::max(largest_half_change, (snap(t + 0.004) - snap(t)).norm());
  }
  EXPECT_LT(largest_change, 0.5 * largest);
  EXPECT_LT(largest_half_change, 0.65 * largest_change);
}

struct IntegrationError {
  double position_m, angle_deg;
};

IntegrationError errorAgainst(const MotionState& truth, const Vec3& position, const Quat& rotation) {
  return {(position - truth.world_from_body.translation).norm(),
          so3::log(rotation.conjugate() * truth.world_from_body.rotation).norm() * 57.29578};
}

std::vector<ImuSample> perfectImu(const Motion& motion, double begin_s, double length_s, int rate_hz) {
  std::vector<ImuSample> samples;
  for (int i = 0; i <= rate_hz * length_s; ++i) {
    const double t = begin_s + static_cast<double>(i) / rate_hz;
    samples.push_back(perfectImuSample(motion.at(t), Time::fromSeconds(t), kGravity));
  }
  return samples;
}

// Classical Runge-Kutta with steps of two samples; the sample between them is the middle.
IntegrationError rungeKuttaError(const Motion& motion, double begin_s, double length_s) {
  const std::vector<ImuSample> samples = perfectImu(motion, begin_s, length_s, 200);
  using State = Eigen::Matrix<double, 10, 1>;  // p, v, q (x y z w)
  const auto rate = [](const State& x, const ImuSample& imu) {
    const Quat q(x[9], x[6], x[7], x[8]);
    State dx;
    dx.head<3>() = x.segment<3>(3);
    dx.segment<3>(3) = q.normalized() * imu.specific_force_B + kGravity;
    const Vec3 w = imu.angular_velocity_B;
    dx.tail<4>() = 0.5 * (q * Quat(0.0, w.x(), w.y(), w.z())).coeffs();
    return dx;
  };
  const MotionState start = motion.at(begin_s);
  State x;
  x << start.world_from_body.translation, start.velocity_W, start.world_from_body.rotation.coeffs();
  constexpr double kStep = 0.01;
  for (size_t i = 0; i + 2 < samples.size(); i += 2) {
    const State k1 = rate(x, samples[i]);
    const State k2 = rate(x + 0.5 * kStep * k1, samples[i + 1]);
    const State k3 = rate(x + 0.5 * kStep * k2, samples[i + 1]);
    const State k4 = rate(x + kStep * k3, samples[i + 2]);
    x += kStep / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
    x.tail<4>().normalize();
  }
  return errorAgainst(motion.at(begin_s + length_s), x.head<3>(), Quat(x[9], x[6], x[7], x[8]));
}

// Integration as in the estimator, at the scenarios' rate.
IntegrationError preintegrationError(const Motion& motion, double begin_s, double length_s) {
  const Preintegration integral(perfectImu(motion, begin_s, length_s, 200), Vec3::Zero(), Vec3::Zero(),
                                ImuCalibration());
  const MotionState start = motion.at(begin_s);
  const Vec3 position = start.world_from_body.translation + start.velocity_W * length_s +
                        0.5 * length_s * length_s * kGravity +
                        start.world_from_body.rotation * integral.motion().alpha;
  return errorAgainst(motion.at(begin_s + length_s), position,
                      start.world_from_body.rotation * integral.motion().gamma);
}

TEST(Motion, IntegratingTheNoiseFreeImuFollowsTheTruth) {
  DiveMotionOptions options;
  options.duration_s = 400.0;
  options.path_length_m = 100.0;
  for (uint64_t seed = 1; seed <= 3; ++seed) {
    const Motion motion = dive(seed, options);
    for (const double begin_s : {0.0, 30.0, 170.0, 300.0}) {  // at rest, inwards, turn, outwards
      for (const bool preintegrated : {false, true}) {
        const IntegrationError error = preintegrated ? preintegrationError(motion, begin_s, 60.0)
                                                     : rungeKuttaError(motion, begin_s, 60.0);
        EXPECT_LT(error.position_m, 0.005) << seed << " from " << begin_s;
        EXPECT_LT(error.angle_deg, 0.01) << seed << " from " << begin_s;
        RecordProperty(
            fmt::format("{}_seed{}_from{:.0f}s_um", preintegrated ? "preintegration" : "rk4", seed, begin_s),
            fmt::format("{:.1f} {:.2g}deg", 1e6 * error.position_m, error.angle_deg));
      }
    }
  }
}

TEST(DiveMotion, StartsAtTheOriginAtRestAndComesBack) {
  const Motion motion = dive(3);
  EXPECT_LT(motion.at(0.0).world_from_body.translation.norm(), 1e-12);
  for (const double t : {0.0, 0.7, 2.0, 4.0}) {
    EXPECT_LT(motion.at(t).velocity_W.norm(), 1e-9);
    EXPECT_LT(motion.at(t).angular_velocity_B.norm(), 1e-9);
  }
  EXPECT_LT(motion.at(600.0).world_from_body.translation.norm(), 2.0);
  EXPECT_NEAR(pathLength(motion, 0.0, 600.0), 150.0, 1.5);
}

TEST(DiveMotion, CanStartMoving) {
  DiveMotionOptions options = shortDive();
  options.starts_at_rest = false;
  EXPECT_GT(dive(3, options).at(0.0).velocity_W.norm(), 0.1);
}

TEST(DiveMotion, SwimsAtADiversSpeedAndTurnsLikeOne) {
  for (uint64_t seed = 1; seed <= 4; ++seed) {
    const Motion motion = dive(seed);
    double slow_speed_sum = 0.0, largest_rate = 0.0, largest_acceleration = 0.0;
    int swimming = 0;
    for (double t = 5.0; t < 590.0; t += 1.0) {
      double distance =
          (motion.at(t + 4.0).world_from_body.translation - motion.at(t).world_from_body.translation).norm() /
          4.0;
      if (distance > 0.1) {
        slow_speed_sum += distance;
        ++swimming;
      }
      EXPECT_LT(distance, 0.45);
      largest_rate = std::max(largest_rate, motion.at(t).angular_velocity_B.norm());
      largest_acceleration = std::max(largest_acceleration, motion.at(t).acceleration_W.norm());
    }
    EXPECT_GT(swimming, 480);
    EXPECT_NEAR(slow_speed_sum / swimming, 0.28, 0.06);
    EXPECT_LT(largest_rate, 1.2);
    EXPECT_GT(largest_rate, 0.3);
    EXPECT_LT(largest_acceleration, 2.0);
  }
}

TEST(DiveMotion, LooksWhereItSwims) {
  const Motion motion = dive(2);
  double cosine_sum = 0.0;
  int count = 0;
  for (double t = 5.0; t < 590.0; t += 0.5) {
    const MotionState state = motion.at(t);
    if (state.velocity_W.norm() < 0.15) continue;
    const Vec3 forward_W =
        state.world_from_body.rotation * (kDiverFromBody.rotation.conjugate() * Vec3::UnitX());
    cosine_sum += forward_W.dot(state.velocity_W.normalized());
    ++count;
  }
  EXPECT_GT(cosine_sum / count, 0.93);
}

TEST(DiveMotion, StaysWithinItsCorridor) {
  CenterlineOptions passage;
  passage.length_m = 75.0;
  const Centerline unmoved = Centerline::generate(passage);
  const Motion motion = makeDiveMotion(unmoved, {}, Rigid3());
  const Centerline line = unmoved.translated(motion.worldShift());
  double s = 0.0;
  for (double t = 0.0; t < 600.0; t += 0.25) {
    const Vec3 position = motion.at(t).world_from_body.translation;
    s = line.nearestArcLength(position, s, 3.0);
    const PassageStation station = line.at(s);
    const Vec3 offset = position - station.position_W;
    const Vec3 left = Vec3::UnitZ().cross(station.tangent_W).normalized();
    EXPECT_LT(std::abs(offset.dot(left)), 0.5 * station.width_m * kCorridorShareOfHalfWidth + 0.15) << t;
    EXPECT_LT(std::abs(offset.z()), 0.5 * station.height_m * kCorridorShareOfHalfHeight + 0.2) << t;
  }
}

TEST(DiveMotion, LiesStillWhenAskedTo) {
  DiveMotionOptions options;
  options.still_phases = {{100.0, 60.0}};
  const Motion motion = dive(5, options);
  for (double t = 100.0; t < 160.0; t += 1.7) {
    EXPECT_LT(motion.at(t).velocity_W.norm(), 1e-6) << t;
    EXPECT_LT(motion.at(t).angular_velocity_B.norm(), 1e-6) << t;
  }
  EXPECT_GT(motion.at(95.0).velocity_W.norm(), 0.05);
}

TEST(DiveMotion, SameSeedSameMotion) {
  EXPECT_EQ(dive(6).at(123.4).world_from_body.translation, dive(6).at(123.4).world_from_body.translation);
  EXPECT_NE(dive(6).at(123.4).world_from_body.translation, dive(7).at(123.4).world_from_body.translation);
}

}  // namespace
}  // namespace lodeline
