#pragma once

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/estimator/dvl/dvl_innovation.h"
#include "lodeline/estimator/dvl/dvl_measurement.h"
#include "lodeline/estimator/dvl/dvl_rows.h"
#include "lodeline/estimator/dvl/dvl_trust.h"
#include "lodeline/estimator/dvl/ping_integrator.h"
#include "lodeline/estimator/sensor/sensor_fusion.h"
#include "lodeline/problem/covariance.h"
#include "lodeline/problem/options/options.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Status of the DVL in a frame. Of several pings, the last in this order counts.
enum class DvlStatus {
  Off,         ///< not requested, or not on board
  NoData,      ///< no ping with lock since the frame before
  Invalid,     ///< velocities that no instrument measures
  Waiting,     ///< they agree, but the sensor has not passed enough tests yet
  Rejected,    ///< all beams disagree with the prediction, or the sensor does not deserve trust
  WaterTrack,  ///< at least one beam, of a velocity through the water
  Used,        ///< at least one beam, of a velocity over the bottom
  Readmitted,  ///< used although it disagrees, because it has done so for long
};
const char* toString(DvlStatus status);

/// Result of the DVL for a frame.
struct DvlEstimate {
  DvlStatus status = DvlStatus::Off;
  int beams = 0;                    ///< beams (or axes) with lock since the frame before, unless waiting
  int used = 0;                     ///< of these
  double innovation_m_per_s = 0.0;  ///< root mean square of predicted minus measured velocities, of all beams
  double scale = 0.0, scale_sigma = 0.0;
  Vec3 misalignment_rad = Vec3::Zero();
  double misalignment_sigma_rad = 0.0;  ///< of the axis that is known least
  /// Velocity of the water in the world, since the first velocity through it.
  std::optional<Vec3> current_W;
  double current_sigma_m_per_s = 0.0;  ///< of the axis that is known least
};

/// Adds a Doppler velocity log to a window. Each ping is carried to the frame after it by inertial readings.
/// Its beams are compared with the predicted velocity. Those within the gate become rows of the frame's
/// DvlMeasurement, while the record of the sensor is good (DvlTrust). Scale and misalignment are states from
/// the start. Velocities through the water add its current as a state that walks.
class DvlFusion final : public SensorFusion {
 public:
  /// `diagnostics` must outlive it.
  DvlFusion(const Rig& rig, const EstimatorOptions& options, Diagnostics* diagnostics);

  std::string_view name() const override { return DvlMeasurement::kSensor; }
  void take(const SensorReadings& readings, std::span<const ImuSample> imu,
            const Vec3& gyroscope_bias_B) override;
  std::shared_ptr<const Measurement> measureBeforeStart(Time time) override;
  void addStatesBeforeStart(Window& window, Prior& prior) const override;
  void start(double tilt_sigma_rad, Window* window, Prior* prior) override;
  void addToNewest(Window& window, Marginalizer& marginalizer) override;
  void remember(const JointCovariance& covariance, Window& window) override;
  void report(const Window& window, SensorEstimates* estimates) const override;
  std::optional<SensorRow> row() const override;
  std::vector<BatchState> batchStates(const Window& window) const override;

 private:
  void reportTaken(const DvlSample& sample, const DvlReading& reading);
  /// The readings up to a frame, carried to it; later ones wait.
  std::vector<std::pair<Time, DvlPing>> pingsUntil(const NavigationState& frame);
  DvlMeasurement measurementOf(std::vector<DvlPing> pings) const;
  /// Adds the current of the water to the window, unless it has it.
  void addCurrent(Window& window, Marginalizer& marginalizer) const;
  /// Removes the rows that disagree with the prediction, or all where the sensor is not trusted.
  DvlStatus judge(Time time, const Window& window, DvlPing* ping);
  void see(DvlStatus status) { estimate_.status = std::max(estimate_.status, status); }
  /// What becomes of a ping without trust.
  DvlStatus readmit(Time time, bool agrees, const DvlInnovation& innovation, DvlPing* ping);
  void reportRejections(Time time);
  void reportCalibration(Time time);

  DvlOptions options_;
  Diagnostics* diagnostics_;
  std::optional<DvlCalibration> dvl_;
  Vec3 gravity_W_;
  double arm_sigma_m_per_s_ = 0.0;  ///< noise of the gyroscope times the lever arm
  PingIntegrator integrator_;
  std::vector<DvlReading> waiting_;
  DvlEstimate estimate_;
  DvlStatus taken_ = DvlStatus::NoData;  ///< of readings that are not used, since the frame before
  JointCovariance covariance_;
  DvlTrust trust_;
  int judged_ = 0, rejected_ = 0;  ///< rows since the start
  bool is_rejection_reported_ = false, is_calibration_reported_ = false;
};

}  // namespace lodeline
