#pragma once

#include <map>
#include <optional>
#include <span>

#include "lodeline/ahrs/magnetometer_readings.h"
#include "lodeline/estimator/magnetometer/earth_field_search.h"
#include "lodeline/estimator/magnetometer/field/field_innovation.h"
#include "lodeline/estimator/magnetometer/field/magnetic_noise_estimator.h"
#include "lodeline/estimator/magnetometer/field/magnetic_step_detector.h"
#include "lodeline/estimator/magnetometer/field/magnetometer_gate.h"
#include "lodeline/estimator/magnetometer/field/student_t_weight.h"
#include "lodeline/estimator/magnetometer/heading_alignment.h"
#include "lodeline/estimator/options/options.h"
#include "lodeline/estimator/problem/covariance.h"
#include "lodeline/estimator/solver/marginalizer.h"
#include "lodeline/estimator/state/magnetometer_states.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// What the magnetometer gave a frame, and what is known of its field.
struct MagnetometerEstimate {
  MagnetometerStatus status = MagnetometerStatus::Off;
  HeadingReference heading_reference = HeadingReference::Start;
  /// Turn about the vertical, rad, that takes the estimator's world to one whose y axis points to that
  /// reference, as known now. 0 where the world was turned before the first pose; nothing while north is
  /// unknown. The estimator's world itself is never turned after its first pose.
  std::optional<double> north_from_world_rad;
  double north_from_world_sigma_rad = 0.0;  ///< of that turn, relative to the first pose's heading
  std::optional<Time> north_found;          ///< where that was only after the first pose
  int field_epoch = 0;                      ///< counts the times that another field was taken for the Earth's
  /// Of the heading against that reference, rad: as the frame's covariance says, and the declination's.
  double heading_sigma_rad = 0.0;
  double declination_sigma_rad = 0.0;
  /// Part of it that the window's covariance has not: of the axes of a magnetometer that was never
  /// calibrated, or of those of an IMU that perhaps never was, against which a calibration turned it.
  double axes_sigma_rad = 0.0;
  /// Estimated field of the Earth and offset of the corrected readings, T; nothing unless fused absolutely.
  std::optional<Vec3> field_W;
  std::optional<Vec3> offset_B;
  std::optional<double> correlated_noise_sigma_T;  ///< lasting error of the field per axis, as learned
};

/// Brings the magnetometer into a window: sorts its readings, turns the world to north at the start, keeps
/// the parameter blocks, asks the gate, and hands each frame its mean field (Frame::magnetometer), of which
/// FactorBuilder makes a factor. Without a magnetometer, or switched off, it leaves everything as it is.
class MagnetometerFusion {
 public:
  /// `options` and `diagnostics` must outlive it. Says so where a magnetometer is on board but not used.
  MagnetometerFusion(const Rig& rig, const EstimatorOptions& options, Diagnostics* diagnostics);

  /// Takes the readings that belong to the frame at the end of `imu`; `imu` as in Estimator::add.
  void take(std::span<const MagnetometerSample> readings, std::span<const ImuSample> imu,
            const Vec3& gyroscope_bias_B);

  /// The window has just started, with `prior` on its first frame: turns both to north where the field
  /// allows, adds the parameter blocks to both and gives the frames their fields. `tilt_sigma_rad`: of the
  /// roll and pitch that the window knows.
  void start(double tilt_sigma_rad, Window* window, Prior* prior);

  /// The newest frame has just been added.
  void addToNewest(Window& window, Marginalizer& marginalizer);

  /// Joint covariance after the window was solved; the next frame's field is judged by it.
  void remember(JointCovariance covariance);

  /// Makes the covariance of the newest frame's state, [dp, dtheta, dv, db_g, db_a] as Estimator claims it,
  /// relative to north where that was found after the first pose; call remember() before.
  void relateToNorth(const Window& window, Eigen::Matrix<double, 15, 15>* covariance) const;

  MagnetometerEstimate estimate(const Window& window) const;

 private:
  bool absolute() const { return use_ == MagnetometerUse::Absolute; }

  /// Of axes that no state stands for, relative and rad.
  double axesSigma() const;
  double offsetSigma() const;
  double floorSigma(const Vec3& field_B) const;
  void align(Window* window, Prior* prior);
  /// Where the first reading comes only after the start.
  void startLate(const MagnetometerMean& mean, Window& window, Marginalizer& marginalizer);
  /// Looks for north in the field as it is known at `time`, if it has not been found yet.
  void findNorth(const Vec3& field_W, Time time);
  /// The newest frame has no field.
  void missField(const Window& window);
  void reportNorthMissing(Time time, const std::string& reason);
  /// Takes another field for the Earth's where that has the better claim; true where it did.
  bool takeBetterField(const MagnetometerMean& mean, Window& window, Marginalizer& marginalizer);
  void takeField(const Vec3& field_W, const MagnetometerMean& mean, Window& window,
                 Marginalizer& marginalizer);
  AzimuthCovariance azimuth(const Window& window) const;
  /// The field that north is found by, T.
  Vec3 northField(const Window& window) const;
  void describeNorth(const Window& window, MagnetometerEstimate* estimate) const;
  void addStates(const HeadingAlignment& alignment, Window* window, Prior* prior) const;
  FieldMeasurement measurementOf(const MagnetometerMean& mean, double variance_scale, bool disturbed);
  /// The mean without what currents on board have added since the start.
  MagnetometerMean withoutSteps(const MagnetometerMean& mean, Window& window);
  void judge(const MagnetometerMean& mean, Window& window, Marginalizer& marginalizer);
  /// Of a mean's white noise, T^2 per axis.
  double whiteVariance(const MagnetometerMean& mean) const;
  /// Of roll and pitch, rad^2 per axis, as the window knows them. The gyroscope adds errors all the time;
  /// none lasts for longer than it takes these to make up the whole.
  TimeCorrelatedError tiltError() const;
  /// What a frame at `now` that is used shall be told of the tilt it takes as given, rad per axis.
  double tiltSigma(Time now);
  void learnErrors(const MagnetometerMean& mean, const FieldCheck& earth, Window& window);
  void beginDisturbance(const MagnetometerMean& mean, Window& window, Marginalizer& marginalizer);
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
  MagneticStepDetector step_;
  std::map<Time, MagnetometerMean> means_;  ///< of frames that wait for their window
  HeadingReference heading_reference_ = HeadingReference::Start;
  EarthFieldSearch search_;
  Time started_;                          ///< first pose
  std::optional<Time> north_found_;       ///< after that
  Vec3 relative_field_W_ = Vec3::Zero();  ///< that north was found by without a state of the field
  int field_epoch_ = 0;
  bool north_missing_reported_ = false;
  JointCovariance covariance_;
  double tilt_variance_rad2_ = 0.0;
  double least_tilt_variance_rad2_ = 0.0;  ///< of those with which a field was used; 0: none was
  bool disturbed_ = false;                 ///< the disturbance is among the window's states
  std::optional<Time> last_seen_;          ///< frame with a field, used or not
  bool rejecting_ = false;
  MagnetometerStatus status_before_ = MagnetometerStatus::Off;  ///< of the last decision
};

}  // namespace lodeline
