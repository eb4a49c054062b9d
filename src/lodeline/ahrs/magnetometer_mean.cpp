#include "lodeline/ahrs/magnetometer_mean.h"

#include <fmt/core.h>

#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/imu/rotation_increment.h"

namespace lodeline {
namespace {

void requireCover(std::span<const FieldSample> samples, std::span<const ImuSample> imu) {
  if (!samples.empty() && !imu.empty() && samples.front().time >= imu.front().time &&
      samples.back().time <= imu.back().time) {
    return;
  }
  if (samples.empty()) throw InputError("no magnetometer reading to average");
  throw InputError(fmt::format(
      "magnetometer readings from {} to {} ns are not covered by {} inertial readings; give those "
      "from the first of them to the frame",
      samples.front().time.nanoseconds(), samples.back().time.nanoseconds(), imu.size()));
}

}  // namespace

MagnetometerMean carryToFrame(std::span<const FieldSample> samples, std::span<const ImuSample> imu,
                              const Vec3& gyroscope_bias_B, double gyroscope_density) {
  requireCover(samples, imu);
  MagnetometerMean mean;
  mean.time = imu.back().time;
  mean.carried.setZero();
  mean.readings = static_cast<int>(samples.size());
  const auto take = [&](const FieldSample& sample, const Quat& frame_from_sample) {
    const Vec3 carried = frame_from_sample * sample.field_B;
    if (&sample == &samples.back()) mean.newest_B = carried;
    mean.field_B += carried;
    mean.carried += frame_from_sample.toRotationMatrix();
  };
  // Iterates backwards from the frame, which needs no intermediate storage.
  const double share = 1.0 / static_cast<double>(samples.size());
  Quat frame_from_later = Quat::Identity();
  size_t left = samples.size();
  double shared_noise_s = 0.0;  // integral of (fraction of readings that the noise rotates) squared
  for (size_t i = imu.size(); i-- > 0 && left > 0;) {
    if (i + 1 == imu.size()) {
      while (left > 0 && samples[left - 1].time == imu[i].time) take(samples[--left], frame_from_later);
      continue;
    }
    const Vec3 rate_0 = imu[i].angular_velocity_B - gyroscope_bias_B;
    const Vec3 rate_1 = imu[i + 1].angular_velocity_B - gyroscope_bias_B;
    const double step_s = (imu[i + 1].time - imu[i].time).seconds();
    while (left > 0 && samples[left - 1].time >= imu[i].time) {
      const double rest_s = (imu[i + 1].time - samples[left - 1].time).seconds();
      const Vec3 rate = rate_1 + (rate_0 - rate_1) * (rest_s / step_s);
      const Quat later_from_sample =
          so3::exp(RotationIncrement(rate, rate_1, rest_s).rotation_vector).conjugate();
      take(samples[--left], frame_from_later * later_from_sample);
    }
    shared_noise_s += step_s * std::pow(share * static_cast<double>(left), 2);
    frame_from_later =
        frame_from_later * so3::exp(RotationIncrement(rate_0, rate_1, step_s).rotation_vector).conjugate();
  }
  mean.field_B *= share;
  mean.carried *= share;
  mean.rotation_sigma_rad = gyroscope_density * std::sqrt(shared_noise_s);
  return mean;
}

}  // namespace lodeline
