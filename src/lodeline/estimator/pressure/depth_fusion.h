#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/estimate.h"
#include "lodeline/estimator/pressure/depth_gate.h"
#include "lodeline/estimator/pressure/depth_measurement.h"
#include "lodeline/estimator/pressure/depth_states.h"
#include "lodeline/estimator/pressure/gauge_monitor.h"
#include "lodeline/estimator/pressure/vertical_motion.h"
#include "lodeline/estimator/pressure/water_density_prior.h"
#include "lodeline/estimator/sensor/sensor_fusion.h"
#include "lodeline/problem/covariance.h"
#include "lodeline/problem/marginalization/marginalizer.h"
#include "lodeline/problem/options/options.h"

namespace lodeline {

/// Adds the pressure sensor to a window. It maintains the parameter blocks, carries readings to their frame,
/// and applies monitor and gate. It gives the frame its depth (DepthMeasurement).
class DepthFusion final : public SensorFusion {
 public:
  /// `diagnostics` must outlive it.
  DepthFusion(const Rig& rig, const EstimatorOptions& options, Diagnostics* diagnostics);

  std::string_view name() const override { return DepthMeasurement::kSensor; }
  void take(const SensorReadings& readings, std::span<const ImuSample> imu,
            const Vec3& gyroscope_bias_B) override;
  void addToNewest(Window& window, Marginalizer& marginalizer) override;
  /// Also updates the prior of the density ratio by known waters for the next solution.
  void remember(const JointCovariance& covariance, Window& window) override;
  void report(const Window& window, SensorEstimates* estimates) const override;
  int restarts() const override { return restarts_; }
  std::vector<BatchState> batchStates(const Window& window) const override;

  DepthEstimate estimate(const Window& window) const;

 private:
  /// Reading minus expectation.
  struct Innovation {
    double value_m = 0.0;
    double sigma_m = 0.0;
    double elapsed_s = 0.0;            ///< since the frame before
    double speed_sigma_m_per_s = 0.0;  ///< of the vertical speed during that time
    double lag_sigma_m = 0.0;          ///< effect of the lag's uncertainty at that speed
  };

  double portSpeed(const Frame& frame) const;
  /// A reading of a gauge with `lag_s`, carried to a frame by the motion of the port.
  CarriedDepth carry(const DepthSample& reading, Time frame_time, double lag_s) const;
  Innovation innovate(const CarriedDepth& depth, const Window& window) const;
  DepthDecision judge(const DepthSample& reading, const CarriedDepth& depth, Window& window,
                      Marginalizer& marginalizer);
  void begin(const CarriedDepth& depth, Window& window, Marginalizer& marginalizer);
  /// Resets the gauge's offset to unknown and removes the depths of the window's frames.
  void restart(const CarriedDepth& depth, Window& window, Marginalizer& marginalizer);
  DepthMeasurement measurementOf(const std::vector<CarriedDepth>& depths, double variance_scale, Time time);
  /// The window's estimate of the ratio without its prior; empty while it has no covariance.
  std::optional<ScalarPrior> seenRatio(const ParameterBlock& scale) const;
  void report(DepthStatus status, const DepthSample& reading);

  DepthOptions options_;
  double unmodelled_density_sigma_ = 0.0;
  /// The ratio by images and known waters, and the likelihood that the latter add; empty where the user
  /// stated it.
  std::optional<ScalarPrior> known_ratio_, likelihood_;
  Diagnostics* diagnostics_;
  std::optional<PressureCalibration> gauge_;
  DepthStatus status_ = DepthStatus::Off;
  std::vector<DepthSample> waiting_;
  VerticalMotion motion_;
  GaugeMonitor health_;
  DepthGate gate_;
  JointCovariance covariance_;
  bool is_slope_wrong_ = false;
  int restarts_ = 0;  ///< frames with the status Restarted
  std::optional<Time> last_used_;
};

}  // namespace lodeline
