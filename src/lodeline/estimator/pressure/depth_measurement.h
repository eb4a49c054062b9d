#pragma once

#include "lodeline/factors/sensors/depth_factor.h"
#include "lodeline/problem/state/measurement.h"

namespace lodeline {

/// Depth measurement of a frame. Its factor is a DepthFactor.
struct DepthMeasurement final : Measurement {
  CarriedDepth depth;
  double sigma_m = 0.0;
  Vec3 port_B = Vec3::Zero();  ///< pressure port, m

  static constexpr std::string_view kSensor = "pressure";
  std::string_view sensor() const override { return kSensor; }
  std::vector<Factor> factors(const MeasurementContext& context) const override;
  std::optional<double> heightSigma_m() const override { return sigma_m; }
  bool wantsBatchState() const override { return true; }
  std::shared_ptr<const Measurement> weighted(int count) const override;
};

}  // namespace lodeline
