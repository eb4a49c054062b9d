#pragma once

#include <map>
#include <optional>
#include <span>

#include "lodeline/ahrs/magnetometer_readings.h"
#include "lodeline/diagnostics.h"
#include "lodeline/estimate.h"
#include "lodeline/estimator/magnetometer/currents/current_compensation.h"
#include "lodeline/estimator/magnetometer/earth_field_search.h"
#include "lodeline/estimator/magnetometer/field/anomaly_scale.h"
#include "lodeline/estimator/magnetometer/field/field_innovation.h"
#include "lodeline/estimator/magnetometer/field/field_measurement.h"
#include "lodeline/estimator/magnetometer/field/magnetic_noise_estimator.h"
#include "lodeline/estimator/magnetometer/field/magnetic_step_detector.h"
#include "lodeline/estimator/magnetometer/field/magnetometer_gate.h"
#include "lodeline/estimator/magnetometer/field/magnetometer_states.h"
#include "lodeline/estimator/magnetometer/field/student_t_weight.h"
#include "lodeline/estimator/magnetometer/heading_alignment.h"
#include "lodeline/estimator/magnetometer/map/mapped_field.h"
#include "lodeline/estimator/sensor/sensor_fusion.h"
#include "lodeline/problem/covariance.h"
#include "lodeline/problem/marginalization/marginalizer.h"
#include "lodeline/problem/options/options.h"

namespace lodeline {

/// Adds the magnetometer to a window. It assigns readings to frames, rotates the world to north at the start,
/// and maintains the parameter blocks. It applies the gate and gives each frame its mean field
/// (FieldMeasurement).
class MagnetometerFusion final : public SensorFusion {
 public:
  /// `options` and `diagnostics` must outlive it. Reports a magnetometer on board that is not used.
  MagnetometerFusion(const Rig& rig, const EstimatorOptions& options, Diagnostics* diagnostics);

  std::string_view name() const override { return FieldMeasurement::kSensor; }
  void take(const SensorReadings& readings, std::span<const ImuSample> imu,
            const Vec3& gyroscope_bias_B) override;
  /// Rotates window and prior to north where the field allows it, adds the parameter blocks to both and
  /// assigns the fields to the frames.
  void start(double tilt_sigma_rad, Window* window, Prior* prior) override;
  void addToNewest(Window& window, Marginalizer& marginalizer) override;
  void remember(const JointCovariance& covariance, Window& window) override;
  /// Converts the covariance to one relative to north: with that of a north that was found after the first
  /// pose, and with the anomaly that the field in force may have (AnomalyScale).
  void relate(const Window& window, Eigen::Matrix<double, 15, 15>* covariance) const override;
  void report(const Window& window, SensorEstimates* estimates) const override;
  /// That of the compensation of currents; empty without current sensors.
  std::optional<SensorRow> row() const override;
  /// Counts replacements of the field that is taken for the Earth's.
  int measurementEpoch() const override { return field_epoch_; }
  std::vector<BatchState> batchStates(const Window& window) const override;

  MagnetometerEstimate estimate(const Window& window) const;

 private:
  /// Mean field of a frame and the currents at its readings.
  struct FrameField {
    MagnetometerMean mean;
    CurrentsAt currents;
  };

  bool absolute() const { return use_ == MagnetometerUse::Absolute; }

  /// Sigma of the axes errors that no state represents, relative and rad.
  double axesSigma() const;
  double offsetSigma() const;
  double floorSigma(const Vec3& field_B) const;
  void align(Window* window, Prior* prior);
  /// Adds the states where the first reading arrives only after the start.
  void startLate(const FrameField& field, Window& window, Marginalizer& marginalizer);
  /// Determines north from the field estimate at `time`, unless it is known already.
  void findNorth(const Vec3& field_W, Time time);
  /// Handles a newest frame without a field.
  void missField(const Window& window);
  void reportNorthMissing(Time time, const std::string& reason);
  /// Replaces the field taken for the Earth's if another one is more plausible (EarthFieldSearch). Returns
  /// true where it did.
  bool takeBetterField(const FrameField& field, Window& window, Marginalizer& marginalizer);
  void takeField(const Vec3& field_W, const FrameField& field, Window& window, Marginalizer& marginalizer);
  /// Discards what gate, noise estimator and step detector have learnt of the field.
  void restartChecks();
  AzimuthCovariance azimuth(const Window& window) const;
  /// The field from which north is determined, T.
  Vec3 northField(const Window& window) const;
  void describeNorth(const Window& window, MagnetometerEstimate* estimate) const;
  void addStates(const HeadingAlignment& alignment, Window* window, Prior* prior) const;
  FieldMeasurement measurementOf(const FrameField& field, double variance_scale, bool disturbed);
  /// The readings whose currents are known, with those, carried to the frame at the end of `imu`.
  void keepMean(std::span<const FieldSample> samples, std::span<const ImuSample> imu,
                const Vec3& gyroscope_bias_B);
  /// The mean minus the field of measured currents: by the window's states, or by the calibration alone where
  /// `window` is null.
  MagnetometerMean withoutCurrents(const FrameField& field, const Window* window) const;
  /// Compares measured currents with their calibration; starts the checks again where that is wrong.
  void checkCurrents(const FrameField& field, Window& window);
  /// Whether the fields of the present currents are too uncertain to learn errors and steps from a mean.
  bool areCurrentsUncertain(const FrameField& field, const Window& window) const;
  /// The mean minus the steps of currents on board since the start.
  FrameField withoutSteps(const FrameField& field, Window& window);
  void judge(const FrameField& field, Window& window, Marginalizer& marginalizer);
  /// Offers a reading that is not the Earth's field to the map. Returns true where the map uses it.
  bool takeByMap(const FrameField& field, const MagnetometerMean& clean, Window& window);
  /// White noise of a mean, T^2 per axis, with that of its currents.
  double whiteVariance(const FrameField& field) const;
  /// Error of the window's roll and pitch, rad^2 per axis. Its correlation time is limited to the time in
  /// which gyroscope noise accumulates to the same variance.
  TimeCorrelatedError tiltError() const;
  /// Sigma of roll and pitch in the factor of a frame at `now`, rad per axis. The factor does not estimate
  /// roll and pitch, so this sigma has to account for their time-correlated error.
  double tiltSigma(Time now);
  /// Adds the deviation of size and dip from the Earth's field; also of fields that are not used.
  void learnAnomaly(const FrameField& field, const FieldCheck& earth, const Window& window);
  /// `clean`: the mean without the fields of currents.
  void learnErrors(const FrameField& field, const MagnetometerMean& clean, Window& window);
  void beginDisturbance(const MagnetometerMean& clean, Window& window, Marginalizer& marginalizer);
  void endDisturbance(Window& window, Marginalizer& marginalizer);
  void reportDecision(const GateDecision& decision, Time time);

  const EstimatorOptions& options_;
  Diagnostics* diagnostics_;
  MagnetometerUse use_ = MagnetometerUse::Off;
  MagnetometerStatus status_ = MagnetometerStatus::Off;
  MagnetometerCalibration calibration_;
  double gyroscope_density_ = 0.0;  ///< rad/s/sqrt(Hz), inflated
  MagnetometerReadings readings_;
  FieldInnovation comparison_;
  MagnetometerGate gate_;
  MagneticNoiseEstimator errors_;
  StudentTWeight deviation_;
  AnomalyScale anomaly_;
  MagneticStepDetector step_;
  MappedField map_;
  std::map<Time, FrameField> means_;  ///< of frames that are not yet in a window
  CurrentCompensation currents_;
  HeadingReference heading_reference_ = HeadingReference::Start;
  EarthFieldSearch search_;
  Time started_;                          ///< time of the first pose
  std::optional<Time> north_found_;       ///< that of the first pose, or later
  Vec3 relative_field_W_ = Vec3::Zero();  ///< from which north was found without a state of the field
  int field_epoch_ = 0;
  bool north_missing_reported_ = false;
  JointCovariance covariance_;
  double tilt_variance_rad2_ = 0.0;
  double least_tilt_variance_rad2_ = 0.0;  ///< smallest variance with which a field was used; 0: none was
  bool disturbed_ = false;                 ///< the disturbance is among the window's states
  std::optional<Time> last_seen_;          ///< last frame with a field, used or not
  bool rejecting_ = false;
  MagnetometerStatus status_before_ = MagnetometerStatus::Off;  ///< of the last decision
};

}  // namespace lodeline
