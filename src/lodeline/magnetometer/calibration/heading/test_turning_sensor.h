#pragma once

#include <random>
#include <vector>

#include "lodeline/imu/test_motion.h"
#include "lodeline/magnetometer/calibration/heading/field_alignment.h"
#include "lodeline/magnetometer/calibration/heading/inertial_residuals.h"

namespace lodeline::test {

/// A hand-held rig that moves like TestMotion, with a magnetometer whose true parameters are known. The field
/// is in units of its magnitude.
struct TurningSensor {
  double duration_s = 30.0;
  double field_rate_hz = 50.0;
  double imu_rate_hz = 200.0;
  double field_sigma = 2e-3;
  double gyroscope_density = 1e-4;
  unsigned seed = 1;
  Vec3 gyroscope_bias = Vec3(0.01, -0.02, 0.015);
  InertialParameters truth = [] {
    InertialParameters p;
    p.soft_iron << 1.02, 0.03, -0.01, 0.03, 0.95, 0.02, -0.01, 0.02, 1.04;
    p.hard_iron = Vec3(0.2, -0.1, 0.3);
    p.body_from_magnetometer = so3::exp(Vec3(0.3, -1.1, 0.6));
    p.dip_rad = 1.0;
    p.time_offset_s = -0.012;
    return p;
  }();
  TestMotion motion;

  std::vector<ImuSample> imu() const {
    std::mt19937_64 engine(seed);
    std::normal_distribution<double> normal(0.0, gyroscope_density * std::sqrt(imu_rate_hz));
    std::vector<ImuSample> samples = motion.readings(-0.5, duration_s + 0.5, imu_rate_hz, gyroscope_bias);
    for (ImuSample& sample : samples) {
      for (int i = 0; i < 3; ++i) sample.angular_velocity_B[i] += normal(engine);
    }
    return samples;
  }

  std::vector<NormalizedFieldSample> field() const {
    std::mt19937_64 engine(1000 + seed);
    std::normal_distribution<double> normal(0.0, field_sigma);
    std::vector<NormalizedFieldSample> samples;
    for (int i = 0; i < duration_s * field_rate_hz; ++i) {
      const double t = i / field_rate_hz;
      const Quat world_from_body = motion.rotation(t + truth.time_offset_s);
      Vec3 reading = truth.hard_iron + truth.soft_iron * (truth.body_from_magnetometer.conjugate() *
                                                          (world_from_body.conjugate() * truth.field_W()));
      for (int k = 0; k < 3; ++k) reading[k] += normal(engine);
      samples.push_back({Time::fromSeconds(t), reading});
    }
    return samples;
  }

  std::vector<NormalizedFieldSample> correctedField() const {
    std::vector<NormalizedFieldSample> samples = field();
    const Mat3 correction = truth.soft_iron.inverse();
    for (NormalizedFieldSample& sample : samples)
      sample.field_M = correction * (sample.field_M - truth.hard_iron);
    return samples;
  }
};

}  // namespace lodeline::test
