#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lodeline/estimator/options/options.h"
#include "lodeline/estimator/pressure/depth_gate.h"
#include "lodeline/estimator/pressure/gauge_monitor.h"
#include "lodeline/estimator/pressure/vertical_motion.h"
#include "lodeline/estimator/pressure/water_density_prior.h"
#include "lodeline/estimator/problem/covariance.h"
#include "lodeline/estimator/solver/marginalizer.h"
#include "lodeline/estimator/state/depth_states.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// What the pressure sensor gave a frame, and what is known of it; see DepthStates.
struct DepthEstimate {
  DepthStatus status = DepthStatus::Off;
  struct Gauge {
    double depth_at_origin_m = 0.0;
    double density_ratio = 1.0, density_ratio_sigma = 0.0;
    double lag_s = 0.0, lag_sigma_s = 0.0;
    double body_depth_m = 0.0;  ///< of the body, as the gauge would read it there
    /// Of the density ratio, beyond what the window's covariance says.
    double unmodelled_sigma = 0.0;
    /// Of the density ratio, before images have said anything of it.
    double told_sigma = 0.0;
    std::optional<ScalarPrior> prior = std::nullopt;  ///< of the density ratio, see ParameterBlock
  };
  std::optional<Gauge> gauge;  ///< nothing until it was heard

  /// For EstimateSources.
  std::optional<double> unmodelledDensitySigma() const {
    return gauge ? std::optional(gauge->unmodelled_sigma) : std::nullopt;
  }
};

/// Brings the pressure sensor into a window: keeps its parameter blocks, carries readings to their frame,
/// asks health and gate, and hands the frame its depth (Frame::depth), of which FactorBuilder makes a factor.
/// Without a sensor, or switched off, it leaves everything as it is.
class DepthFusion {
 public:
  /// `diagnostics` must outlive it.
  DepthFusion(const Rig& rig, const EstimatorOptions& options, Diagnostics* diagnostics);

  /// Takes the readings that belong to the next frame.
  void take(std::span<const DepthSample> readings);
  /// The newest frame has just been added, with its predicted state.
  void addToNewest(Window& window, Marginalizer& marginalizer);
  /// Joint covariance after the window was solved; the next reading is judged by it, and the next solution
  /// believes what known waters say of the ratio that was found.
  void remember(const JointCovariance& covariance, Window& window);

  DepthEstimate estimate(const Window& window) const;

 private:
  /// A reading less what is expected.
  struct Innovation {
    double value_m = 0.0;
    double sigma_m = 0.0;
    double elapsed_s = 0.0;            ///< since the frame before
    double speed_sigma_m_per_s = 0.0;  ///< of the vertical speed that led here
    double lag_sigma_m = 0.0;          ///< what the unknown part of the lag makes of that speed
  };

  double portSpeed(const Frame& frame) const;
  /// A reading carried to a frame by the port's motion, as of a gauge with `lag_s`.
  CarriedDepth carry(const DepthSample& reading, Time frame_time, double lag_s) const;
  Innovation innovate(const CarriedDepth& depth, const Window& window) const;
  DepthDecision judge(const DepthSample& reading, const CarriedDepth& depth, Window& window,
                      Marginalizer& marginalizer);
  void begin(const CarriedDepth& depth, Window& window, Marginalizer& marginalizer);
  /// Takes the gauge's offset as unknown, and back what the window's frames were told.
  void restart(const CarriedDepth& depth, Window& window, Marginalizer& marginalizer);
  DepthMeasurement measurementOf(const std::vector<CarriedDepth>& depths, double variance_scale, Time time);
  /// What the window says of the ratio by itself, without its prior; nothing while it has no covariance.
  std::optional<ScalarPrior> seenRatio(const ParameterBlock& scale) const;
  void report(DepthStatus status, const DepthSample& reading);

  DepthOptions options_;
  double unmodelled_density_sigma_ = 0.0;
  /// The ratio as images and known waters have it, and what the latter add; nothing where it was told.
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
  std::optional<Time> last_used_;
};

}  // namespace lodeline
