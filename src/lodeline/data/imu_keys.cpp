#include "lodeline/data/imu_keys.h"

#include <fmt/core.h>

#include "lodeline/base/error.h"

namespace lodeline {
namespace {

double density(const std::string& key, CalibrationMap* map) {
  const double value = map->number(key);
  if (!(value > 0.0)) {
    throw InputError(
        fmt::format("{} is {:g}; it must be a positive density (from the datasheet or an Allan analysis)",
                    map->at(key), value));
  }
  return value;
}

}  // namespace

ImuNoise readImuNoise(CalibrationMap* map) {
  ImuNoise noise;
  noise.gyroscope_density_rad_per_s_sqrtHz = density("gyroscope_noise_density", map);
  noise.gyroscope_random_walk_rad_per_s2_sqrtHz = density("gyroscope_random_walk", map);
  noise.accelerometer_density_m_per_s2_sqrtHz = density("accelerometer_noise_density", map);
  noise.accelerometer_random_walk_m_per_s3_sqrtHz = density("accelerometer_random_walk", map);
  return noise;
}

}  // namespace lodeline
