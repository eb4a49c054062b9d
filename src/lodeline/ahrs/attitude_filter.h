#pragma once

#include <deque>
#include <optional>

#include "lodeline/ahrs/field_gate.h"
#include "lodeline/ahrs/gyroscope_bias_filter.h"
#include "lodeline/ahrs/heading_filter.h"
#include "lodeline/ahrs/magnetometer_readings.h"
#include "lodeline/ahrs/rest_detector.h"
#include "lodeline/diagnostics.h"
#include "lodeline/rig.h"

namespace lodeline {

struct AttitudeFilterOptions {
  double inclination_time_constant_s = 3.0;
  GyroscopeBiasOptions bias;
  RestDetectorOptions rest;
  FieldGateOptions gate;
  HeadingFilterOptions heading;
  double longest_rejection_s = 60.0;  ///< then a disturbed field is used with its error
  double max_gap_s = 1.0;  ///< after a longer gap in the readings, the attitude is initialized again
  double gap_rate_sigma_rad_per_s = 0.3;
  /// Field at the site, where known, as reference for magnitude and dip. World axes east, north, up, T.
  std::optional<Vec3> site_field_W;
};

/// Use of the magnetometer for the heading.
enum class HeadingStatus {
  NoMagnetometer,  ///< heading is relative to the first attitude
  Waiting,         ///< no magnetometer reading yet, or no new one for 1.5 s (frozen or silent)
  Magnetic,        ///< heading follows the field
  WrongNorm,       ///< disturbed: the gyroscope alone propagates the heading
  WrongDip,
  WrongHeading,
  Readmitted,  ///< disturbed for so long that the field is used again, with a low weight
};
const char* toString(HeadingStatus status);

struct AttitudeEstimate {
  Time time;
  Quat world_from_body = Quat::Identity();  ///< world: x magnetic (or true) east, y north, z up
  double heading_sigma_rad = 0.0;           ///< without a magnetometer, relative to the first attitude
  Vec3 gyroscope_bias_B = Vec3::Zero();
  bool at_rest = false;
  HeadingStatus status = HeadingStatus::NoMagnetometer;
};

/// Estimates attitude and heading from gyroscope, accelerometer and magnetometer alone.
///
/// The structure follows Laidig & Seel, "VQF: Highly accurate IMU orientation estimation with bias estimation
/// and magnetic disturbance rejection", Information Fusion 91, 2023. The gyroscope gives the attitude in a
/// slowly drifting frame I. The specific force is rotated into I and low-pass filtered there, which averages
/// motion out and leaves gravity; gravity then corrects the inclination. The gyroscope bias is estimated at
/// rest, and in motion from the inclination corrections. Heading is separate from inclination, so a magnetic
/// disturbance cannot tilt the attitude. Unlike VQF, heading uses a Kalman filter of one angle instead of a
/// fixed gain; the filter includes the uncertainty of the bias.
class AttitudeFilter {
 public:
  /// `magnetometer`: its calibration; without one, field readings are ignored. options.site_field_W can
  /// contain the declination at the position; heading then refers to true north. `diagnostics` must outlive
  /// the filter.
  AttitudeFilter(const AttitudeFilterOptions& options,
                 const std::optional<MagnetometerCalibration>& magnetometer, Diagnostics* diagnostics);

  /// Adds a reading, in order of time. Non-finite readings and readings not later than the previous one are
  /// reported and ignored.
  void add(const ImuSample& sample);

  /// Adds a reading. Its time is on the IMU's clock, corrected for any lag of the sensor, at most 0.5 s
  /// before the last IMU reading, or after it. Readings that MagnetometerReadings rejects are ignored.
  void add(const MagnetometerSample& sample);

  /// Estimate at the last IMU reading; nothing before the first.
  const std::optional<AttitudeEstimate>& estimate() const { return estimate_; }

  const std::optional<FieldShape>& referenceField() const { return gate_.reference(); }

 private:
  struct Moment {
    Time time;
    Quat level_from_body;  ///< level frame: z up, arbitrary heading
    double turned_rad;     ///< rotation angle since the start
  };

  bool isUsable(const ImuSample& sample);
  void start(const ImuSample& sample);
  void turn(const ImuSample& sample, double step_s);
  void level(const ImuSample& sample, double step_s);
  void remember(Time time);
  void takeFields();
  void takeField(const FieldSample& sample);
  void judge(FieldVerdict verdict, double measured_rad, double step_s);
  void publish(Time time);

  AttitudeFilterOptions options_;
  double magnetometer_rate_hz_ = 0.0;
  std::optional<MagnetometerReadings> readings_;  ///< nothing without a magnetometer
  Diagnostics* diagnostics_;
  double declination_rad_ = 0.0;

  RestDetector rest_;
  GyroscopeBiasFilter bias_;
  FieldGate gate_;
  HeadingFilter heading_;

  std::optional<ImuSample> last_;
  Quat inertial_from_body_ = Quat::Identity();   ///< from the gyroscope alone
  Quat level_from_inertial_ = Quat::Identity();  ///< from the accelerometer
  LowPass<Vec3> force_I_;
  bool at_rest_ = false;
  double turned_rad_ = 0.0;

  std::deque<Moment> history_;
  int readings_for_unit_ = 0;
  std::deque<FieldSample> waiting_;
  std::optional<Time> last_field_time_;
  double last_field_turned_rad_ = 0.0;
  double rejected_s_ = 0.0;
  HeadingStatus status_;
  std::optional<AttitudeEstimate> estimate_;
};

}  // namespace lodeline
