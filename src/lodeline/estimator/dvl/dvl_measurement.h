#pragma once

#include <memory>
#include <vector>

#include "lodeline/estimator/dvl/dvl_factor.h"
#include "lodeline/problem/options/dvl_options.h"
#include "lodeline/problem/state/measurement.h"

namespace lodeline {

/// Velocity of the instrument along a direction of its frame.
struct DvlRow {
  Vec3 direction_D = Vec3::UnitX();
  double velocity_m_per_s = 0.0;
};

/// The rows of one ping: its valid beams, or the three axes of its velocity.
struct DvlPing {
  DvlGeometry geometry;
  std::vector<DvlRow> rows;
  bool is_velocity = false;
  double sigma_m_per_s = 0.0;  ///< of each row, with that of the motion since

  bool isThroughWater() const { return geometry.track == DvlTrack::Water; }
};

/// DVL measurement of a frame: the pings since the frame before. Each row's factor is a DvlFactor under a
/// Cauchy loss. Inertial readings carry the frame's velocity back to the time of the ping, so that a factor
/// contains one frame only. Those of pings through the water contain the current of the water as well. It may
/// have any value, so that such pings tell neither the whole velocity nor the scale.
struct DvlMeasurement final : Measurement {
  std::vector<DvlPing> pings;
  double robust_scale_sigmas = 2.0;
  /// Sigma of the scale and of the misalignment before any measurement, relative and rad.
  double calibration_sigma = 0.0;

  static constexpr std::string_view kSensor = "dvl";
  std::string_view sensor() const override { return kSensor; }
  std::vector<Factor> factors(const MeasurementContext& context) const override;
  bool measuresVelocity() const override { return true; }
  double speedInformation() const override;
  std::optional<CarriedVelocity> velocity() const override;
  bool wantsBatchState() const override { return true; }
  /// The noise of the pings that are left does not shrink with those that are left out.
  std::shared_ptr<const Measurement> weighted(int) const override {
    return std::make_shared<DvlMeasurement>(*this);
  }
};

}  // namespace lodeline
