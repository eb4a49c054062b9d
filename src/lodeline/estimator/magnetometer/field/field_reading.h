#pragma once

#include "lodeline/problem/state/measurement.h"

namespace lodeline {

/// The magnetic field at a frame, whether the gate takes it for the Earth's or not. Maps compare it along
/// both ways of a loop. It makes no term of the cost.
struct FieldReading final : Measurement {
  Vec3 field_B = Vec3::Zero();  ///< T, body axes, without hard iron and fields of currents
  double sigma_T = 0.0;         ///< of its independent noise, per axis

  static constexpr std::string_view kSensor = "magnetometer_reading";
  std::string_view sensor() const override { return kSensor; }
  std::vector<Factor> factors(const MeasurementContext&) const override { return {}; }
  bool isForBatch() const override { return false; }
  std::shared_ptr<const Measurement> weighted(int) const override {
    return std::make_shared<FieldReading>(*this);
  }
};

}  // namespace lodeline
