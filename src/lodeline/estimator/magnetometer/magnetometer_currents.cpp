// Functions of MagnetometerFusion that take measured currents on board into account.
#include <cmath>

#include "lodeline/estimator/magnetometer/magnetometer_fusion.h"

namespace lodeline {

void MagnetometerFusion::keepMean(std::span<const FieldSample> samples, std::span<const ImuSample> imu,
                                  const Vec3& gyroscope_bias_B) {
  FrameField field;
  CurrentCompensation::Known known;
  if (currents_.isOnBoard()) {
    known = currents_.withCurrents(samples, imu.back().time);
    if (known.samples.empty()) return;
    samples = known.samples;
    field.currents = known.currents;
  }
  field.mean = carryToFrame(samples, imu, gyroscope_bias_B, gyroscope_density_);
  means_[imu.back().time] = std::move(field);
}

MagnetometerMean MagnetometerFusion::withoutCurrents(const FrameField& field, const Window* window) const {
  if (!currents_.isOnBoard()) return field.mean;
  const Vec3 field_B = currents_.field_B(field.currents, window);
  MagnetometerMean mean = field.mean;
  mean.field_B -= mean.carried * field_B;
  mean.newest_B -= mean.carried * field_B;
  return mean;
}

void MagnetometerFusion::checkCurrents(const FrameField& field, Window& window) {
  currents_.describe(field.currents, window, covariance_);
  const MagnetometerStates states(window);
  const Quat body_from_world = window.newest().worldFromBody().rotation.conjugate();
  const Vec3 expected_B = body_from_world * states.field_W() + field.mean.carried * states.offset_B();
  if (currents_.check(field.mean.time, field.currents, field.mean.field_B - expected_B, whiteVariance(field),
                      window)) {
    // Steps that were found with the wrong compensation come back into the readings.
    states.offset->sudden_variance += step_.step_B().squaredNorm();
    restartChecks();
    status_before_ = MagnetometerStatus::Off;
  }
}

bool MagnetometerFusion::areCurrentsUncertain(const FrameField& field, const Window& window) const {
  constexpr double kUncertain_T = 0.05e-6;  // half of the smallest step that is looked for
  return currents_.isOnBoard() &&
         currents_.fieldVariance_T2(field.currents, window, covariance_) > kUncertain_T * kUncertain_T;
}

std::optional<SensorRow> MagnetometerFusion::row() const {
  if (!currents_.isOnBoard() || use_ == MagnetometerUse::Off) return std::nullopt;
  return SensorRow{"currents", toString(currents_.status()), currents_.columns()};
}

}  // namespace lodeline
