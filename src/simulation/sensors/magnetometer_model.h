#pragma once

#include <optional>

#include "lodeline/rig.h"
#include "simulation/sensors/magnetic_disturbance.h"
#include "simulation/shared/random.h"

namespace lodeline {

/// Errors of a real magnetometer. Its reading at time t in the magnetometer frame M is
///   reading(t) = S R_M_B R_B_W(t') m_W(t') + h + sum_i k_i I_i(t') + c t' + w(t) + white noise,
/// Here t' = t - lag, and m_W is the Earth's field plus the disturbances. The reading is clipped to
/// +-range and rounded to the resolution; some readings repeat the previous row. S is the soft iron (A =
/// S^-1 corrects it), h the hard iron, w its random walk, k_i I_i the field of a current.
struct MagnetometerErrors {
  Mat3 soft_iron = Mat3::Identity();
  Vec3 hard_iron_T = Vec3::Zero();
  Vec3 hard_iron_creep_T_per_s = Vec3::Zero();
  double hard_iron_walk_T_per_sqrt_s = 0.0;
  Rigid3 body_from_magnetometer;
  double noise_density_T_per_sqrtHz = 0.0;
  double lag_s = 0.0;
  double repeat_share = 0.0;
  double range_T = 1.0;
  double resolution_T = 0.0;  ///< 0: continuous
};

/// The field in frame M, corrected for soft and hard iron.
inline Vec3 corrected(const Vec3& reading_M, const MagnetometerErrors& errors) {
  return errors.soft_iron.inverse() * (reading_M - errors.hard_iron_T);
}

class MagnetometerModel {
 public:
  /// `motion` must outlive the model.
  MagnetometerModel(const Motion& motion, const Vec3& field_W, MagneticDisturbances disturbances,
                    const MagnetometerErrors& errors, double rate_hz, uint64_t seed);

  /// The reading at `time_s`; call it in order of time.
  Vec3 measure(double time_s);

 private:
  const Motion& motion_;
  Vec3 field_W_;
  MagneticDisturbances disturbances_;
  MagnetometerErrors errors_;
  double sigma_T_;
  Random noise_, repeats_, walk_;
  Vec3 walked_T_ = Vec3::Zero();
  std::optional<double> measured_s_;
  std::optional<Vec3> last_;
};

struct MagnetometerSpecimenOptions {
  bool noise = true;
  bool iron = true;    ///< soft and hard iron of the housing, 1 degree of misalignment relative to the IMU
  bool creep = false;  ///< 0.1 to 0.3 uT over `duration_s`
  bool lag_and_repeats = false;  ///< 14 to 16 ms, 29 % repeated (BROAD)
  double duration_s = 600.0;
};
/// Draws the errors of one specimen in one housing; each draw is independent of the selection of the others.
/// Noise and range are those of an IMU grade's magnetometer: 0.01 uT/sqrt(Hz) and +-800 uT for the
/// Microstrain parts, 0.1 uT/sqrt(Hz) and 0.15 uT of resolution for consumer parts.
MagnetometerErrors drawMagnetometerErrors(std::string_view imu_grade,
                                          const MagnetometerSpecimenOptions& options, uint64_t seed);

}  // namespace lodeline
