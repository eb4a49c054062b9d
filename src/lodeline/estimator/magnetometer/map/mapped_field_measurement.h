#pragma once

#include "lodeline/problem/state/measurement.h"

namespace lodeline {

/// Magnetometer reading of a frame in a mapped anomaly. Its factor is a MagnetometerMapFactor.
struct MappedFieldMeasurement final : Measurement {
  Vec3 reading_B = Vec3::Zero();     ///< without hard iron and currents, T
  Vec3 mapped_M = Vec3::Zero();      ///< the field by the map, in its axes, T
  Mat3 covariance_W = Mat3::Zero();  ///< of both, T^2

  static constexpr std::string_view kSensor = "magnetometer_map";
  /// The parameter block with the heading of the map's axes in the world, rad.
  static constexpr const char* kHeading = "magnetic_map_heading";

  std::string_view sensor() const override { return kSensor; }
  std::vector<Factor> factors(const MeasurementContext& context) const override;
  void fixLinearizationPoints(const Window& window) const override;
  /// The map is that of the run, so it cannot be solved again.
  bool isForBatch() const override { return false; }
  std::shared_ptr<const Measurement> weighted(int count) const override;
};

}  // namespace lodeline
