#pragma once

#include <vector>

#include "lodeline/ahrs/magnetometer_mean.h"
#include "lodeline/factors/sensors/magnetometer_field_factor.h"
#include "lodeline/problem/state/measurement.h"

namespace lodeline {

/// Magnetometer measurement of a frame. Its factor is a MagnetometerFieldFactor, or a
/// MagnetometerRelativeFactor where it is relative.
struct FieldMeasurement final : Measurement {
  MagnetometerMean mean;
  bool relative = false;  ///< relative to the frame before, not to the field
  FieldNoise noise;
  bool disturbed = false;          ///< the field has a disturbance to be estimated
  std::vector<double> currents_A;  ///< mean currents at the readings, whose fields are states (CurrentStates)

  static constexpr std::string_view kSensor = "magnetometer";
  std::string_view sensor() const override { return kSensor; }
  std::vector<Factor> factors(const MeasurementContext& context) const override;
  bool isRelative() const override { return relative; }
  void fixLinearizationPoints(const Window& window) const override;
  /// Where the gate accepted it as the Earth's field.
  bool isForBatch() const override { return !disturbed && !relative; }
  std::shared_ptr<const Measurement> weighted(int count) const override;
};

}  // namespace lodeline
