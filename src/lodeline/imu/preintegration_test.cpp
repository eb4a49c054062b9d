#include "lodeline/imu/preintegration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/imu/test_motion.h"

namespace lodeline {
namespace {

using namespace inertial_error;
using testing::HasSubstr;
using testing::ThrowsMessage;

const Vec3 kGyroscopeBias(0.01, -0.02, 0.015);
const Vec3 kAccelerometerBias(-0.05, 0.1, 0.08);
const TestMotion kMotion;

Preintegration integrate(std::span<const ImuSample> samples, const Vec3& gyroscope_bias = Vec3::Zero(),
                         const Vec3& accelerometer_bias = Vec3::Zero()) {
  return Preintegration(samples, gyroscope_bias, accelerometer_bias, ImuCalibration());
}

Eigen::Matrix<double, 9, 1> errorAtRate(double rate_hz) {
  const auto samples = kMotion.readings(2.0, 3.0, rate_hz, kGyroscopeBias, kAccelerometerBias);
  return motionError(kMotion.state(samples.front().time), kMotion.state(samples.back().time),
                     integrate(samples, kGyroscopeBias, kAccelerometerBias), standardGravity_W());
}

TEST(Preintegration, FollowsASmoothMotionForASecond) {
  const auto error = errorAtRate(200.0);
  EXPECT_LT(error.segment<3>(kAlpha).norm(), 1e-4);
  EXPECT_LT(error.segment<3>(kBeta).norm(), 1e-4);
  // A thousandth of the noise error of a quiet gyroscope (1.7e-4 rad/s/sqrt(Hz)) in that time.
  EXPECT_LT(error.segment<3>(kTheta).norm(), 2e-7);
}

TEST(Preintegration, ErrorFallsWithTheSquareOfTheStepAndThatOfRotationWithItsCube) {
  const auto coarse = errorAtRate(100.0);
  const auto fine = errorAtRate(200.0);
  const auto ratio = [&](int at) { return coarse.segment<3>(at).norm() / fine.segment<3>(at).norm(); };
  EXPECT_NEAR(ratio(kAlpha), 4.0, 0.2);
  EXPECT_NEAR(ratio(kBeta), 4.0, 0.2);
  EXPECT_NEAR(ratio(kTheta), 8.0, 0.4);
}

/// Axes with errors of up to 2 %.
SensorAxes wrongAxes() {
  SensorAxes axes;
  axes << 0.012, -0.006, 0.009, 0.004, -0.015, -0.007, 0.003, 0.011, 0.02;
  return axes;
}

std::vector<ImuSample> trueReadings() {
  return kMotion.readings(1.0, 1.1, 200.0, kGyroscopeBias, kAccelerometerBias);
}

/// Readings of a sensor with the wrong axes.
std::vector<ImuSample> readingsBy(Vec3 ImuSample::*sensor, const Vec3& bias) {
  const Mat3 true_from_reading = Mat3::Identity() + wrongAxes().reshaped(3, 3);
  std::vector<ImuSample> readings = trueReadings();
  for (ImuSample& reading : readings)
    reading.*sensor = true_from_reading.inverse() * (reading.*sensor - bias) + bias;
  return readings;
}

// Integration of the readings of such a gyroscope.
TEST(Preintegration, CorrectsForTheAxesOfTheGyroscopeToFirstOrder) {
  const SensorAxes axes = wrongAxes();
  const RelativeMotion truth = integrate(trueReadings(), kGyroscopeBias, kAccelerometerBias).motion();
  const Preintegration p = integrate(readingsBy(&ImuSample::angular_velocity_B, kGyroscopeBias),
                                     kGyroscopeBias, kAccelerometerBias);
  const auto off = [&](double share) {
    const RelativeMotion motion =
        p.correctedFor(kGyroscopeBias, kAccelerometerBias, {.gyroscope = share * axes});
    return Vec3((motion.alpha - truth.alpha).norm(), (motion.beta - truth.beta).norm(),
                so3::log(motion.gamma * truth.gamma.conjugate()).norm());
  };
  EXPECT_GT(off(0.0)[2], 1e-3);  // the correction is significant
  for (int part = 0; part < 3; ++part) EXPECT_LT(off(1.0)[part], 0.02 * off(0.0)[part]) << part;
}

// The same for an accelerometer; its effect is linear.
TEST(Preintegration, CorrectsForTheAxesOfTheAccelerometer) {
  const SensorAxes axes = wrongAxes();
  const RelativeMotion truth = integrate(trueReadings(), kGyroscopeBias, kAccelerometerBias).motion();
  const Preintegration p = integrate(readingsBy(&ImuSample::specific_force_B, kAccelerometerBias),
                                     kGyroscopeBias, kAccelerometerBias);
  EXPECT_GT((p.motion().beta - truth.beta).norm(), 1e-3);  // the correction is significant
  const RelativeMotion motion = p.correctedFor(kGyroscopeBias, kAccelerometerBias, {.accelerometer = axes});
  EXPECT_LT((motion.alpha - truth.alpha).norm(), 1e-12);
  EXPECT_LT((motion.beta - truth.beta).norm(), 1e-12);
  EXPECT_EQ(motion.gamma.coeffs(), p.motion().gamma.coeffs());
}

// Two axes rotate out of phase: the error of integrating mean rates accumulates.
TEST(Preintegration, FollowsConing) {
  const double tilt = 0.1, frequency = 3.0;  // rad, rad/s
  const auto attitude = [&](double t) {
    return so3::exp(tilt * Vec3(std::cos(frequency * t), std::sin(frequency * t), 0.0));
  };
  const auto rate_B = [&](double t) -> Vec3 {
    return frequency * Vec3(-std::sin(tilt) * std::sin(frequency * t),
                            std::sin(tilt) * std::cos(frequency * t), std::cos(tilt) - 1.0);
  };
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 60 * 200; ++i) {
    samples.push_back({Time::fromSeconds(i / 200.0), rate_B(i / 200.0), -standardGravity_W()});
  }
  const Quat truth = attitude(0.0).conjugate() * attitude(60.0);
  EXPECT_LT(so3::log(truth.conjugate() * integrate(samples).motion().gamma).norm(), 5e-8);
}

TEST(Preintegration, IsExactForATurnAtConstantRateUnderConstantAcceleration) {
  const Vec3 rate(0.4, 1.1, -0.7), acceleration_W(0.5, -1.0, 2.0);
  std::vector<ImuSample> samples;
  for (int i = 0; i <= 3; ++i) {
    const Time time = Time::fromNanoseconds(i * 100'000'000);
    const Quat world_from_body = so3::exp(rate * time.seconds());
    samples.push_back({time, rate, world_from_body.conjugate() * (acceleration_W - standardGravity_W())});
  }
  const RelativeMotion motion = integrate(samples).motion();
  const Vec3 force_W = acceleration_W - standardGravity_W();
  EXPECT_LT((motion.alpha - 0.5 * 0.3 * 0.3 * force_W).norm(), 1e-14);
  EXPECT_LT((motion.beta - 0.3 * force_W).norm(), 1e-14);
  EXPECT_LT(so3::log(motion.gamma.conjugate() * so3::exp(0.3 * rate)).norm(), 1e-14);
}

TEST(Preintegration, BiasJacobianIsTheDerivativeOfTheIntegral) {
  const auto samples = kMotion.readings(1.0, 1.5, 200.0);
  const Preintegration at = integrate(samples, kGyroscopeBias, kAccelerometerBias);
  constexpr double kStep = 1e-5;
  for (int i = 0; i < 6; ++i) {
    Eigen::Matrix<double, 6, 1> step = kStep * Eigen::Matrix<double, 6, 1>::Unit(i);
    const RelativeMotion plus =
        integrate(samples, kGyroscopeBias + step.head<3>(), kAccelerometerBias + step.tail<3>()).motion();
    const RelativeMotion minus =
        integrate(samples, kGyroscopeBias - step.head<3>(), kAccelerometerBias - step.tail<3>()).motion();
    Eigen::Matrix<double, 9, 1> numeric;
    numeric << plus.alpha - minus.alpha, plus.beta - minus.beta,
        so3::log(plus.gamma * minus.gamma.conjugate());
    numeric /= 2.0 * kStep;
    EXPECT_LT((at.biasJacobian().col(i) - numeric).norm(), 1e-6 * numeric.norm()) << i;
  }
}

TEST(Preintegration, CorrectionForMovedBiasesIsOfFirstOrder) {
  const auto samples = kMotion.readings(0.0, 0.5, 200.0);
  const Preintegration at = integrate(samples);
  const auto miss = [&](double scale) {
    const RelativeMotion corrected =
        at.correctedFor(scale * Vec3(0.01, -0.02, 0.01), scale * Vec3(0.1, 0.1, -0.2));
    const RelativeMotion again =
        integrate(samples, scale * Vec3(0.01, -0.02, 0.01), scale * Vec3(0.1, 0.1, -0.2)).motion();
    return (corrected.alpha - again.alpha).norm() + (corrected.beta - again.beta).norm() +
           so3::log(corrected.gamma * again.gamma.conjugate()).norm();
  };
  EXPECT_LT(miss(1.0), 1e-3);
  EXPECT_NEAR(miss(1.0) / miss(0.5), 4.0, 0.1);
}

TEST(Preintegration, RepropagationEqualsAFreshIntegration) {
  const auto samples = kMotion.readings(0.0, 0.2, 200.0);
  Preintegration moved = integrate(samples);
  moved.repropagate(kGyroscopeBias, kAccelerometerBias);
  const Preintegration fresh = integrate(samples, kGyroscopeBias, kAccelerometerBias);
  EXPECT_EQ(moved.motion().alpha, fresh.motion().alpha);
  EXPECT_EQ(moved.motion().beta, fresh.motion().beta);
  EXPECT_EQ(moved.motion().gamma.coeffs(), fresh.motion().gamma.coeffs());
  EXPECT_EQ(moved.biasJacobian(), fresh.biasJacobian());
  EXPECT_EQ(moved.covariance(), fresh.covariance());
  EXPECT_EQ(moved.whitening(), fresh.whitening());
  EXPECT_EQ(moved.gyroscopeBias(), kGyroscopeBias);
  const Time middle = Time::fromSeconds(0.1);
  EXPECT_EQ(moved.gammaAt(middle).gamma.coeffs(), fresh.gammaAt(middle).gamma.coeffs());
}

TEST(Preintegration, AsksForRepropagationWhenTheCorrectionGrowsLarge) {
  const Preintegration at = integrate(kMotion.readings(0.0, 0.5, 200.0), kGyroscopeBias, kAccelerometerBias);
  const PreintegrationOptions options;
  const Vec3 gyroscope_step(options.max_rotation_correction_rad / 0.5, 0.0, 0.0);
  const Vec3 accelerometer_step(0.0, options.max_velocity_correction_m_per_s / 0.5, 0.0);
  EXPECT_FALSE(at.needsRepropagation(kGyroscopeBias, kAccelerometerBias));
  EXPECT_FALSE(at.needsRepropagation(kGyroscopeBias + 0.9 * gyroscope_step,
                                     kAccelerometerBias + 0.9 * accelerometer_step));
  EXPECT_TRUE(at.needsRepropagation(kGyroscopeBias + 1.1 * gyroscope_step, kAccelerometerBias));
  EXPECT_TRUE(at.needsRepropagation(kGyroscopeBias, kAccelerometerBias + 1.1 * accelerometer_step));
}

TEST(Preintegration, IntermediateRotationRunsFromIdentityToGamma) {
  const Preintegration at = integrate(kMotion.readings(1.0, 1.2, 200.0));
  EXPECT_EQ(at.gammaAt(at.start()).gamma.coeffs(), Quat::Identity().coeffs());
  EXPECT_EQ(at.gammaAt(at.start()).theta_by_gyroscope_bias, Mat3::Zero());
  EXPECT_EQ(at.gammaAt(at.end()).gamma.coeffs(), at.motion().gamma.coeffs());
  EXPECT_LT((at.gammaAt(at.end()).theta_by_gyroscope_bias - at.biasJacobian().block<3, 3>(kTheta, 0)).norm(),
            1e-15);
  // On a reading, and between two.
  for (const double t : {1.05, 1.1234}) {
    const Quat truth = kMotion.rotation(1.0).conjugate() * kMotion.rotation(t);
    EXPECT_LT(so3::log(truth.conjugate() * at.gammaAt(Time::fromSeconds(t)).gamma).norm(), 1e-7) << t;
  }
}

TEST(Preintegration, IntermediateRotationFollowsTheGyroscopeBias) {
  const auto samples = kMotion.readings(1.0, 1.2, 200.0);
  const Time time = Time::fromSeconds(1.1234);
  const Vec3 change(2e-4, -1e-4, 3e-4);
  const Quat expected = integrate(samples, change).gammaAt(time).gamma;
  const Quat corrected = integrate(samples).gammaAt(time).correctedFor(change);
  EXPECT_LT(so3::log(expected.conjugate() * corrected).norm(), 1e-9);
  EXPECT_GT(so3::log(expected.conjugate() * integrate(samples).gammaAt(time).gamma).norm(), 1e-5);
}

TEST(Preintegration, IntermediateRotationOutsideTheIntervalIsRefused) {
  const Preintegration at = integrate(kMotion.readings(1.0, 1.2, 200.0));
  EXPECT_THROW(at.gammaAt(Time::fromSeconds(0.9999)), InputError);
  EXPECT_THROW(at.gammaAt(Time::fromSeconds(1.2001)), InputError);
}

TEST(Preintegration, RefusesWhatIsNoInterval) {
  auto samples = kMotion.readings(0.0, 0.1, 200.0);
  const std::span<const ImuSample> all(samples);
  EXPECT_THAT([&] { integrate(all.first(0)); }, ThrowsMessage<InputError>(HasSubstr("there are 0")));
  EXPECT_THAT([&] { integrate(all.first(1)); }, ThrowsMessage<InputError>(HasSubstr("there are 1")));
  samples[3].time = samples[2].time;
  EXPECT_THAT([&] { integrate(all); },
              ThrowsMessage<InputError>(HasSubstr("10000000 ns follows 10000000 ns")));
  // Zero length.
  EXPECT_THAT([&] { integrate(all.subspan(2, 2)); }, ThrowsMessage<InputError>(HasSubstr("must increase")));
  samples[3].time = samples[1].time;
  EXPECT_THROW(integrate(all), InputError);
}

TEST(Preintegration, RefusesReadingsAndNoiseThatAreNoNumbers) {
  auto samples = kMotion.readings(0.0, 0.1, 200.0);
  ImuCalibration imu;
  imu.noise.gyroscope_random_walk_rad_per_s2_sqrtHz = 0.0;
  EXPECT_THAT([&] { Preintegration(samples, Vec3::Zero(), Vec3::Zero(), imu); },
              ThrowsMessage<InputError>(HasSubstr("positive")));
  imu.noise.gyroscope_random_walk_rad_per_s2_sqrtHz = std::nan("");
  EXPECT_THROW(Preintegration(samples, Vec3::Zero(), Vec3::Zero(), imu), InputError);
  samples[4].specific_force_B.y() = std::nan("");
  EXPECT_THAT([&] { integrate(samples); }, ThrowsMessage<InputError>(HasSubstr("20000000 ns")));
}

}  // namespace
}  // namespace lodeline
