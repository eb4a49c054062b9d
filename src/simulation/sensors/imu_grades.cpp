#include <fmt/core.h>

#include <array>
#include <cmath>
#include <numbers>

#include "lodeline/diagnostics.h"
#include "lodeline/util/angles.h"
#include "simulation/sensors/imu_model.h"

namespace lodeline {
namespace {

constexpr double kDegreePerHour = kDegree / 3600.0;
constexpr double kMilliG = 9.80665e-3;
constexpr double kDegreePerSecondPerG = kDegree / 9.80665;

TriadErrors triad(double noise_density, double random_walk, double bias_instability, double range) {
  TriadErrors errors;
  errors.noise_density = noise_density;
  errors.random_walk = random_walk;
  errors.bias_instability = bias_instability;
  errors.range = range;
  return errors;
}

// Noise, instability, turn-on bias, scale and misalignment of the class as stated by manufacturers. They do
// not state random walks. These are chosen to exceed the minimum due to the instability after about a quarter
// of an hour, as in Allan plots of such parts. Warm-up: a drift over the first ten minutes of about one
// turn-on bias. Sensitivity to specific force: typical of tactical (0.01-0.05 deg/s/g) and consumer parts
// (0.1).
const std::array<ImuGrade, 3>& grades() {
  static const std::array<ImuGrade, 3> table = {{
      {"gx5-25", 200.0, triad(0.005 * kDegree, 2e-6, 8.0 * kDegreePerHour, 300.0 * kDegree),
       triad(0.025 * kMilliG, 2e-5, 0.04 * kMilliG, 8.0 * 9.80665), 0.04 * kDegree, 2.0 * kMilliG, 5e-4,
       0.05 * kDegree, 0.02 * kDegree, 1.0 * kMilliG, 0.03 * kDegreePerSecondPerG},
      {"gv7", 200.0, triad(0.0031 * kDegree, 5e-7, 2.0 * kDegreePerHour, 300.0 * kDegree),
       triad(0.030 * kMilliG, 1e-5, 0.02 * kMilliG, 8.0 * 9.80665), 0.05 * kDegree, 2.5 * kMilliG, 5e-4,
       0.05 * kDegree, 0.015 * kDegree, 0.8 * kMilliG, 0.01 * kDegreePerSecondPerG},
      {"consumer", 200.0, triad(0.01 * kDegree, 1e-5, 30.0 * kDegreePerHour, 500.0 * kDegree),
       triad(0.3 * kMilliG, 1.5e-4, 0.2 * kMilliG, 8.0 * 9.80665), 1.0 * kDegree, 30.0 * kMilliG, 1e-2,
       0.5 * kDegree, 0.2 * kDegree, 8.0 * kMilliG, 0.1 * kDegreePerSecondPerG},
  }};
  return table;
}

// Rows: scale error of one axis (diagonal) and the two small angles of its misalignment.
Mat3 drawMatrix(double scale_error, double misalignment_rad, Random& random) {
  Mat3 matrix = Mat3::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      matrix(row, column) += (row == column ? scale_error : misalignment_rad) * random.normal();
    }
  }
  return matrix;
}

void drawTriad(const ImuGrade& grade, const SpecimenOptions& o, double turn_on, double warm_up,
               Random& random, TriadErrors& errors) {
  const Vec3 bias = turn_on * random.normal3();
  const Mat3 matrix = drawMatrix(grade.scale_error, grade.misalignment_rad, random);
  const Vec3 drift = warm_up * random.normal3();
  const double warm_up_time_s = random.uniform(250.0, 600.0);
  if (o.turn_on_bias) errors.turn_on_bias = bias;
  if (o.scale_and_misalignment) errors.matrix = matrix;
  if (o.warm_up) errors.warm_up = drift;
  errors.warm_up_time_s = warm_up_time_s;
  if (!o.noise) errors.noise_density = errors.random_walk = errors.bias_instability = 0.0;
}

}  // namespace

const ImuGrade& imuGrade(std::string_view name) {
  for (const ImuGrade& grade : grades()) {
    if (grade.name == name) return grade;
  }
  throw UsageError(fmt::format("there is no IMU grade '{}'; there are gx5-25, gv7 and consumer", name));
}

std::vector<std::string_view> imuGradeNames() {
  std::vector<std::string_view> names;
  for (const ImuGrade& grade : grades()) names.push_back(grade.name);
  return names;
}

ImuErrors drawImuErrors(const ImuGrade& grade, const SpecimenOptions& options, uint64_t seed) {
  ImuErrors errors{grade.gyroscope, grade.accelerometer};
  Random random(seed, "imu/specimen");
  drawTriad(grade, options, grade.gyroscope_turn_on_rad_per_s, grade.gyroscope_warm_up_rad_per_s, random,
            errors.gyroscope);
  drawTriad(grade, options, grade.accelerometer_turn_on_m_per_s2, grade.accelerometer_warm_up_m_per_s2,
            random, errors.accelerometer);
  if (options.g_sensitivity) {
    Random own(seed, "imu/g-sensitivity");
    for (int axis = 0; axis < 3; ++axis)
      errors.g_sensitivity.col(axis) = grade.g_sensitivity_rad_s_per_m_s2 * own.normal3();
  }
  return errors;
}

ImuNoise statedNoise(const ImuErrors& errors) {
  // Allan deviation of a random walk: K sqrt(tau / 3); of flicker noise: B sqrt(2 ln 2 / pi).
  const auto walk = [](const TriadErrors& e) {
    const double flicker = e.bias_instability * std::sqrt(2.0 * std::numbers::ln2 / std::numbers::pi);
    return std::hypot(e.random_walk, flicker / std::sqrt(100.0 / 3.0));
  };
  return {errors.gyroscope.noise_density, walk(errors.gyroscope), errors.accelerometer.noise_density,
          walk(errors.accelerometer)};
}

}  // namespace lodeline
