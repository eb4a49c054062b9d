// Calibrates a magnetometer from readings of a rotated sensor. Here they are simulated, with known soft and
// hard iron:
//   example_3_calibrate_magnetometer

#include <cmath>
#include <cstdio>
#include <exception>
#include <random>
#include <vector>

#include "lodeline/magnetometer/iron/iron_calibration.h"

int main() try {
  // reading = A^-1 field + h, T.
  lodeline::Mat3 soft_iron;
  soft_iron << 1.06, 0.02, -0.01, 0.02, 0.97, 0.03, -0.01, 0.03, 1.02;
  const lodeline::Vec3 hard_iron_T(12e-6, -7e-6, 20e-6);
  constexpr double kField_T = 45.6e-6;
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::vector<lodeline::Vec3> readings;
  for (int i = 0; i < 2000; ++i) {
    const lodeline::Vec3 direction =
        lodeline::Vec3(normal(random), normal(random), normal(random)).normalized();
    const lodeline::Vec3 noise_T = 0.1e-6 * lodeline::Vec3(normal(random), normal(random), normal(random));
    readings.push_back(soft_iron * (kField_T * direction) + hard_iron_T + noise_T);
  }

  lodeline::IronCalibrationOptions options;
  options.field_strength_T = kField_T;  // from the World Magnetic Model for the site
  const lodeline::IronCalibration calibration = lodeline::calibrateIron(readings, options);
  const lodeline::Vec3 found_uT = 1e6 * calibration.fit.hard_iron;
  const lodeline::Vec3 error_T = calibration.fit.hard_iron - hard_iron_T;
  const lodeline::Mat3 rest = calibration.fit.iron_correction * soft_iron - lodeline::Mat3::Identity();
  std::printf("model %s from %d readings, hard iron %.3f %.3f %.3f uT\n",
              lodeline::toString(calibration.fit.model), calibration.fit.readings, found_uT.x(), found_uT.y(),
              found_uT.z());
  std::printf("errors: hard iron %.4f uT, soft iron %.4f %%\n", 1e6 * error_T.norm(), 100.0 * rest.norm());
  return error_T.norm() < 0.05e-6 && rest.norm() < 1e-3 ? 0 : 3;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
