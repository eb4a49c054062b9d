#include "simulation/sensors/magnetometer_model.h"

#include <cmath>
#include <utility>

#include "lodeline/geometry/so3.h"
#include "lodeline/util/angles.h"

namespace lodeline {

MagnetometerModel::MagnetometerModel(const Motion& motion, const Vec3& field_W,
                                     MagneticDisturbances disturbances, const MagnetometerErrors& errors,
                                     double rate_hz, uint64_t seed)
    : motion_(motion),
      field_W_(field_W),
      disturbances_(std::move(disturbances)),
      errors_(errors),
      sigma_T_(errors.noise_density_T_per_sqrtHz * std::sqrt(rate_hz)),
      noise_(seed, "magnetometer/white"),
      repeats_(seed, "magnetometer/repeats"),
      walk_(seed, "magnetometer/walk") {}

Vec3 MagnetometerModel::measure(double time_s) {
  const Vec3 noise = sigma_T_ * noise_.normal3();
  const double elapsed_s = time_s - measured_s_.value_or(time_s);
  measured_s_ = time_s;
  walked_T_ += errors_.hard_iron_walk_T_per_sqrt_s * std::sqrt(elapsed_s) * walk_.normal3();
  const bool repeat = repeats_.chance(errors_.repeat_share);
  if (repeat && last_) return *last_;
  const double sensed_s = time_s - errors_.lag_s;
  const Rigid3 world_from_body = motion_.at(sensed_s).world_from_body;
  const Vec3 field_B =
      world_from_body.rotation.conjugate() * (field_W_ + disturbances_.at(world_from_body, sensed_s));
  const Vec3 field_M = errors_.body_from_magnetometer.rotation.conjugate() * field_B;
  Vec3 reading = errors_.soft_iron * field_M + errors_.hard_iron_T +
                 errors_.hard_iron_creep_T_per_s * sensed_s + walked_T_ + noise;
  if (disturbances_.currents_M) reading += disturbances_.currents_M(sensed_s);
  reading = reading.cwiseMax(-errors_.range_T).cwiseMin(errors_.range_T);
  if (errors_.resolution_T > 0.0) {
    reading = (reading / errors_.resolution_T).array().round().matrix() * errors_.resolution_T;
  }
  last_ = reading;
  return reading;
}

MagnetometerErrors drawMagnetometerErrors(std::string_view imu_grade, const MagnetometerSpecimenOptions& o,
                                          uint64_t seed) {
  Random random(seed, "magnetometer/specimen");
  Mat3 distortion = Mat3::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column <= row; ++column) {
      const double entry = (row == column ? 0.04 : 0.02) * random.normal();
      distortion(row, column) += entry;
      if (row != column) distortion(column, row) += entry;
    }
  }
  const double hard_iron_T = random.uniform(6e-6, 20e-6);
  const Vec3 hard_iron_direction = random.direction();
  const double misalignment_rad = random.uniform(0.5, 1.5) * kDegree;
  const Vec3 misalignment_axis = random.direction();
  const double creep_T = random.uniform(0.1e-6, 0.3e-6);
  const Vec3 creep_direction = random.direction();
  const double lag_s = random.uniform(0.014, 0.016);

  const bool consumer = imu_grade == "consumer";
  MagnetometerErrors errors;
  errors.range_T = consumer ? 4900e-6 : 800e-6;
  errors.resolution_T = consumer && o.noise ? 0.15e-6 : 0.0;
  if (o.noise) errors.noise_density_T_per_sqrtHz = consumer ? 0.1e-6 : 0.01e-6;
  if (o.iron) {
    errors.soft_iron = distortion;
    errors.hard_iron_T = hard_iron_T * hard_iron_direction;
    errors.body_from_magnetometer = Rigid3(so3::exp(misalignment_rad * misalignment_axis), Vec3::Zero());
  }
  if (o.creep) errors.hard_iron_creep_T_per_s = creep_T / o.duration_s * creep_direction;
  if (o.lag_and_repeats) {
    errors.lag_s = lag_s;
    errors.repeat_share = 0.29;
  }
  return errors;
}

}  // namespace lodeline
