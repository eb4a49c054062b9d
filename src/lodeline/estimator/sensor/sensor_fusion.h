#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "lodeline/estimate.h"
#include "lodeline/estimator/sensor/batch_state.h"
#include "lodeline/problem/covariance.h"
#include "lodeline/problem/marginalization/marginalizer.h"
#include "lodeline/problem/state/window.h"
#include "lodeline/sensors/sensor_readings.h"

namespace lodeline {

/// Adds one kind of sensor to a window: takes its readings, maintains its parameter blocks, decides what is
/// used, and gives each frame its measurement (Frame::measurements). Without the sensor, or switched off, it
/// changes nothing. The estimator calls the functions in this order for each frame.
class SensorFusion {
 public:
  virtual ~SensorFusion() = default;

  /// That of its measurements (Measurement::sensor).
  virtual std::string_view name() const = 0;

  /// Takes the readings that belong to the frame at the end of `imu`; `imu` as in Estimator::add.
  virtual void take(const SensorReadings& readings, std::span<const ImuSample> imu,
                    const Vec3& gyroscope_bias_B) = 0;

  /// Measurement of a frame at `time` before the start, from the readings since the last one; null where the
  /// sensor is of no use for a start with one camera.
  virtual std::shared_ptr<const Measurement> measureBeforeStart(Time /*time*/) { return nullptr; }
  /// Adds the states that these measurements need, at their initial values, to a window and its prior. The
  /// window has them already where a start has failed.
  virtual void addStatesBeforeStart(Window& /*window*/, Prior& /*prior*/) const {}

  /// Called once, when the window has just started, with `prior` on its first frame. `tilt_sigma_rad`: sigma
  /// of the window's roll and pitch.
  virtual void start(double /*tilt_sigma_rad*/, Window* /*window*/, Prior* /*prior*/) {}

  /// Adds the measurement to the newest frame, which has just been added to the window with its predicted
  /// state.
  virtual void addToNewest(Window& window, Marginalizer& marginalizer) = 0;

  /// Stores the joint covariance of the solved window, with which the next reading is gated.
  virtual void remember(const JointCovariance& covariance, Window& window) = 0;

  /// Changes the reported covariance of the newest frame's state, of [dp, dtheta, dv, db_g, db_a].
  virtual void relate(const Window& /*window*/, Eigen::Matrix<double, 15, 15>* /*covariance*/) const {}

  /// Adds its own kind of estimate of the newest frame.
  virtual void report(const Window& window, SensorEstimates* estimates) const = 0;

  /// What files and summaries say of the newest frame; empty where they have separate code, and without
  /// the sensor. The columns never change.
  virtual std::optional<SensorRow> row() const { return std::nullopt; }

  /// Number of changes since which earlier measurements are of no use for the batch solver.
  virtual int measurementEpoch() const { return 0; }
  /// Number of restarts of the sensor's walking states.
  virtual int restarts() const { return 0; }
  /// The parameter blocks that it has in the window, for the batch solver.
  virtual std::vector<BatchState> batchStates(const Window& /*window*/) const { return {}; }
};

}  // namespace lodeline
