#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/estimate.h"
#include "lodeline/estimator/initialization/mono_initializer.h"
#include "lodeline/estimator/magnetometer/magnetometer_fusion.h"
#include "lodeline/estimator/mode/mode_machine.h"
#include "lodeline/estimator/pressure/depth_fusion.h"
#include "lodeline/estimator/self_calibration/intrinsics_model_selection.h"
#include "lodeline/estimator/sensor/sensor_fusion.h"
#include "lodeline/estimator/uncertainty/covariance_inflation.h"
#include "lodeline/estimator/uncertainty/inertial_covariance_propagation.h"
#include "lodeline/estimator/uncertainty/scale_observability.h"
#include "lodeline/estimator/visual/landmark_linearization_cache.h"
#include "lodeline/estimator/zero_velocity/stationary_detector.h"
#include "lodeline/problem/factor_builder.h"
#include "lodeline/problem/marginalization/marginalizer.h"
#include "lodeline/problem/options/options.h"
#include "lodeline/problem/state/camera_states.h"
#include "lodeline/problem/state/window.h"

namespace lodeline {

class InertialMonitor;

/// Visual-inertial odometry over a sliding window of keyframes and recent frames (paper section III).
class Estimator {
 public:
  Estimator(const Rig& rig, const EstimatorOptions& options, Diagnostics* diagnostics);
  ~Estimator();

  /// Adds one frame: what the front end tracked, and the inertial readings since the frame before (both ends
  /// on the frames' times; for the first frame all readings there are), and the other sensors' since the
  /// frame before. Throws InputError, and leaves the estimator as it was, where
  /// frame or inertial readings do not follow on the frame before.
  FrameEstimate add(const FrameTracks& tracks, std::span<const ImuSample> imu,
                    const SensorReadings& readings = {});

  bool initialized() const { return !window_.empty(); }
  /// Whether images contradict the gyroscope at the newest frame.
  bool isGyroscopeDoubted() const;
  const Window& window() const { return window_; }
  const Rig& rig() const { return rig_; }
  const EstimatorOptions& options() const { return options_; }
  const Prior& prior() const { return marginalizer_.prior(); }
  /// One for each kind of sensor beside cameras and IMU, in the order of their terms.
  const std::vector<std::unique_ptr<SensorFusion>>& sensors() const { return sensors_; }
  /// Names of the columns in FrameEstimate::sensor_rows.
  std::vector<std::string> sensorColumns() const;

  /// Landmarks that left the window since the last call, in order.
  std::vector<MapPoint> takeMapPoints() { return marginalizer_.takeMapPoints(); }
  /// Landmarks that are still in it.
  std::vector<MapPoint> currentMapPoints() const;

 private:
  void checkOrder(Time time, std::span<const ImuSample> imu) const;
  ObservationList observationsOf(const FrameTracks& tracks) const;
  bool initialize(const FrameTracks& tracks, const ObservationList& observations,
                  std::span<const ImuSample> imu, FrameEstimate* estimate);
  void addSensorRows(FrameEstimate* estimate) const;
  bool startMonocular(Time time, ObservationList observations, std::span<const ImuSample> imu);
  bool startAtOnce(Time time, const ObservationList& observations, FrameEstimate* estimate);
  /// The states of the calibration, for a window that starts.
  void addCalibration(Prior* prior);
  void insertFrame(Time time, const ObservationList& observations, std::span<const ImuSample> imu);
  void optimize(FrameEstimate* estimate);
  /// Relinearizes the window after vision loss. With one camera the robust losses also start wide again.
  void reinitializeAfterVisionLoss();
  /// Marginalizes the frames that exceed the window's size, once the start is over. No linearization point is
  /// frozen before the scale is known.
  void marginalizeWindow(const FrameEstimate& estimate);
  /// Lets the intrinsics, which are fixed at first, be estimated.
  void freeIntrinsics();
  /// Adds the sensors to a window that has just started. The magnetometer turns it to north.
  void startSensors();
  void rememberCovariance(const JointCovariance& covariance, FrameEstimate* estimate);
  void report(const FrameTracks& tracks, FrameEstimate* estimate);

  Rig rig_;
  std::vector<std::shared_ptr<const Camera>> cameras_;
  EstimatorOptions options_;
  Diagnostics* diagnostics_;
  FactorBuilder factors_;
  Marginalizer marginalizer_;
  MonoInitializer mono_initializer_;
  std::vector<Vec3>
      camera_rotations_;  ///< FrameTracks::camera_rotations of the newest frame before the start
  std::vector<std::unique_ptr<SensorFusion>> sensors_;
  IntrinsicsModelSelection intrinsics_model_selection_;
  ScaleObservability scale_;
  LandmarkLinearizationCache linearization_cache_;
  StationaryDetector rest_;
  std::unique_ptr<InertialMonitor> monitor_;
  Eigen::Matrix<double, 15, 15> known_;  ///< of the newest frame, before doubts that no state represents
  bool rests_ = false;                   ///< at the newest frame
  InertialCovariancePropagation inertial_covariance_propagation_;
  CovarianceInflation covariance_inflation_;
  Window window_;
  std::vector<ImuSample> imu_before_start_;
  std::optional<Time> last_time_;
  FrameId next_frame_id_ = 0;
  ModeMachine mode_;
};

}  // namespace lodeline
