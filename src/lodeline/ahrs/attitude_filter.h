#pragma once

#include <deque>
#include <optional>

#include "lodeline/ahrs/field_gate.h"
#include "lodeline/ahrs/gyroscope_bias_filter.h"
#include "lodeline/ahrs/heading_filter.h"
#include "lodeline/ahrs/magnetometer_readings.h"
#include "lodeline/ahrs/rest_detector.h"
#include "lodeline/sensors/rig.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

struct AttitudeFilterOptions {
  double inclination_time_constant_s = 3.0;
  GyroscopeBiasOptions bias;
  RestDetectorOptions rest;
  FieldGateOptions gate;
  HeadingFilterOptions heading;
  double longest_rejection_s = 60.0;  ///< then a disturbed field is used with the error that it shows
  double max_gap_s = 1.0;             ///< without readings for longer, attitude starts anew
  double gap_rate_sigma_rad_per_s = 0.3;
  /// Field at the site, where known; strength and dip are judged against it. World axes east, north, up, T.
  std::optional<Vec3> site_field_W;
};

/// What became of the magnetometer.
enum class HeadingStatus {
  NoMagnetometer,  ///< heading counts from the first attitude
  Waiting,         ///< there is a magnetometer, but no new reading yet, or none for 1.5 s: frozen or silent
  Magnetic,        ///< held by the field
  WrongNorm,       ///< disturbed: carried by the gyroscope
  WrongDip,
  WrongHeading,
  Readmitted,  ///< disturbed for so long that it is better than nothing; used with little weight
};
const char* toString(HeadingStatus status);

struct AttitudeEstimate {
  Time time;
  Quat world_from_body = Quat::Identity();  ///< world: x magnetic (or true) east, y north, z up
  double heading_sigma_rad = 0.0;  ///< about up; relative to the first attitude without a magnetometer
  Vec3 gyroscope_bias_B = Vec3::Zero();
  bool at_rest = false;
  HeadingStatus status = HeadingStatus::NoMagnetometer;
};

/// Attitude and heading from gyroscope, accelerometer and magnetometer alone.
///
/// Follows Laidig & Seel, "VQF: Highly accurate IMU orientation estimation with bias estimation and magnetic
/// disturbance rejection", Information Fusion 91, 2023, in its structure: the gyroscope's attitude in a frame
/// I that drifts slowly; the specific force, turned into I, where motion averages out and gravity stays,
/// low-pass filtered and made to point up; the gyroscope's bias at rest and from the corrections of
/// inclination in motion; and heading apart from inclination, so that no magnetic disturbance ever tilts
/// anything. Heading is a Kalman filter of one angle, with the uncertainty of the bias in it, instead of a
/// filter of fixed gain.
class AttitudeFilter {
 public:
  /// `magnetometer`: its calibration; without one readings of the field are not used. A position's
  /// declination can be given with options.site_field_W: heading is then that of true north. `diagnostics`
  /// must outlive the filter.
  AttitudeFilter(const AttitudeFilterOptions& options,
                 const std::optional<MagnetometerCalibration>& magnetometer, Diagnostics* diagnostics);

  /// Readings in order of time; those that are not finite or not later than the ones before are reported and
  /// passed over.
  void add(const ImuSample& sample);

  /// Times are on the IMU's clock, with any lag of the sensor taken off; up to 0.5 s before the last IMU
  /// reading, or after it. What MagnetometerReadings finds unusable is passed over.
  void add(const MagnetometerSample& sample);

  /// At the last IMU reading; nothing before the first.
  const std::optional<AttitudeEstimate>& estimate() const { return estimate_; }

  const std::optional<FieldShape>& referenceField() const { return gate_.reference(); }

 private:
  struct Moment {
    Time time;
    Quat level_from_body;  ///< level frame: z up, any heading
    double turned_rad;     ///< since the start
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
  Quat inertial_from_body_ = Quat::Identity();   ///< by the gyroscope alone
  Quat level_from_inertial_ = Quat::Identity();  ///< by the accelerometer
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
