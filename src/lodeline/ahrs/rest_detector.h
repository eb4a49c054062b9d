#pragma once

#include "lodeline/ahrs/low_pass.h"
#include "lodeline/rig.h"

namespace lodeline {

struct RestDetectorOptions {
  double time_constant_s = 0.5;             ///< of the means with which readings are compared
  double shortest_s = 1.5;                  ///< time for which readings must stay close to their means
  double rate_deviation_rad_per_s = 0.035;  ///< 2 deg/s
  double force_deviation_m_per_s2 = 0.5;
};

/// Stationary detector: a sensor is at rest while its readings stay close to their own means (Laidig & Seel,
/// "VQF", Information Fusion 2023, section 3.5). A constant rotation looks like a bias here; the bias filter
/// distinguishes them.
class RestDetector {
 public:
  explicit RestDetector(const RestDetectorOptions& options)
      : options_(options), rate_(options.time_constant_s), force_(options.time_constant_s) {}

  /// `step_s`: time since the previous sample.
  bool update(const ImuSample& sample, double step_s) {
    const Vec3& rate = rate_.update(sample.angular_velocity_B, step_s);
    const Vec3& force = force_.update(sample.specific_force_B, step_s);
    const bool is_close =
        (sample.angular_velocity_B - rate).cwiseAbs().maxCoeff() < options_.rate_deviation_rad_per_s &&
        (sample.specific_force_B - force).cwiseAbs().maxCoeff() < options_.force_deviation_m_per_s2;
    still_s_ = is_close ? still_s_ + step_s : 0.0;
    return still_s_ >= options_.shortest_s;
  }

  /// Mean of the gyroscope's readings, rad/s.
  const Vec3& meanRate_B() const { return rate_.value(); }

  void reset() {
    still_s_ = 0.0;
    rate_.reset();
    force_.reset();
  }

 private:
  RestDetectorOptions options_;
  LowPass<Vec3> rate_, force_;
  double still_s_ = 0.0;
};

}  // namespace lodeline
