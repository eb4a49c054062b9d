#include "lodeline/ahrs/attitude_filter.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "lodeline/imu/gravity.h"
#include "lodeline/imu/gravity_alignment.h"
#include "lodeline/imu/rotation_increment.h"

namespace lodeline {
namespace {

constexpr double kHistory_s = 0.5;
constexpr double kSilent_s = 1.5;
constexpr double kLongestMagneticStepDetector_s = 0.5;  ///< limits the weight after a pause

std::optional<FieldShape> shapeOf(const std::optional<Vec3>& field_W) {
  if (!field_W) return std::nullopt;
  return FieldShape::of(*field_W);
}

Quat aboutUp(double angle_rad) { return Quat(Eigen::AngleAxisd(angle_rad, Vec3::UnitZ())); }

}  // namespace

const char* toString(HeadingStatus status) {
  switch (status) {
    case HeadingStatus::NoMagnetometer:
      return "no_magnetometer";
    case HeadingStatus::Waiting:
      return "waiting";
    case HeadingStatus::Magnetic:
      return "magnetic";
    case HeadingStatus::WrongNorm:
      return "wrong_norm";
    case HeadingStatus::WrongDip:
      return "wrong_dip";
    case HeadingStatus::WrongHeading:
      return "wrong_heading";
    case HeadingStatus::Readmitted:
      return "readmitted";
  }
  return "";
}

AttitudeFilter::AttitudeFilter(const AttitudeFilterOptions& options,
                               const std::optional<MagnetometerCalibration>& magnetometer,
                               Diagnostics* diagnostics)
    : options_(options),
      diagnostics_(diagnostics),
      rest_(options.rest),
      bias_(options.bias, options.inclination_time_constant_s),
      gate_(options.gate, shapeOf(options.site_field_W)),
      heading_(options.heading),
      force_I_(options.inclination_time_constant_s),
      status_(magnetometer ? HeadingStatus::Waiting : HeadingStatus::NoMagnetometer) {
  if (magnetometer) {
    magnetometer_rate_hz_ = magnetometer->rate_hz;
    readings_.emplace(*magnetometer, diagnostics);
  }
  if (options.site_field_W) {
    declination_rad_ = std::atan2(options.site_field_W->x(), options.site_field_W->y());
  }
}

bool AttitudeFilter::isUsable(const ImuSample& sample) {
  if (!sample.angular_velocity_B.allFinite() || !sample.specific_force_B.allFinite()) {
    diagnostics_->report(
        Severity::Warning, "imu_not_finite",
        fmt::format("IMU reading at {} ns is not finite; passed over", sample.time.nanoseconds()));
    return false;
  }
  if (last_ && sample.time <= last_->time) {
    diagnostics_->report(Severity::Warning, "imu_disorder",
                         fmt::format("IMU stamp {} ns does not follow on {} ns; reading passed over",
                                     sample.time.nanoseconds(), last_->time.nanoseconds()));
    return false;
  }
  return true;
}

void AttitudeFilter::add(const ImuSample& sample) {
  if (!isUsable(sample)) return;
  const double step_s = last_ ? (sample.time - last_->time).seconds() : 0.0;
  if (!last_ || step_s > options_.max_gap_s) {
    start(sample);
  } else {
    turn(sample, step_s);
    level(sample, step_s);
  }
  last_ = sample;
  remember(sample.time);
  takeFields();
  publish(sample.time);
}

void AttitudeFilter::start(const ImuSample& sample) {
  if (last_) {
    diagnostics_->report(Severity::Warning, "attitude_restart",
                         fmt::format("no IMU readings for {:.1f} s before {} ns; attitude starts anew",
                                     (sample.time - last_->time).seconds(), sample.time.nanoseconds()));
  }
  inertial_from_body_ = Quat::Identity();
  level_from_inertial_ = levelWithZeroYaw(sample.specific_force_B.normalized());
  force_I_.reset();
  rest_.reset();
  bias_.restart();
  history_.clear();
  if (readings_ || last_) {
    heading_.forget();
  } else {
    heading_.define(0.0);
  }
}

void AttitudeFilter::turn(const ImuSample& sample, double step_s) {
  at_rest_ = rest_.update(sample, step_s);
  if (at_rest_) at_rest_ = bias_.updateAtRest(rest_.meanRate_B(), step_s);
  const Vec3 increment = RotationIncrement(last_->angular_velocity_B - bias_.bias_B(),
                                           sample.angular_velocity_B - bias_.bias_B(), step_s)
                             .rotation_vector;
  inertial_from_body_ = (inertial_from_body_ * so3::exp(increment)).normalized();
  turned_rad_ += increment.norm();
}

void AttitudeFilter::level(const ImuSample& sample, double step_s) {
  const Vec3& force_I = force_I_.update(inertial_from_body_ * sample.specific_force_B, step_s);
  const Vec3 force_W = level_from_inertial_ * force_I;
  Vec3 correction_W = Vec3::Zero();
  // In free fall, the specific force does not indicate the vertical.
  if (force_W.norm() > 0.5 * kStandardGravity) {
    const Quat correction = Quat::FromTwoVectors(force_W, Vec3::UnitZ());
    correction_W = so3::log(correction);
    level_from_inertial_ = (correction * level_from_inertial_).normalized();
  }
  const Mat3 level_from_body = (level_from_inertial_ * inertial_from_body_).toRotationMatrix();
  bias_.follow(level_from_body, step_s);
  if (!at_rest_) bias_.updateInMotion(correction_W, step_s);
  const Vec3 up_B = level_from_body.row(2);
  heading_.predict(std::sqrt(up_B.dot(bias_.covariance() * up_B)), step_s);
  if (step_s > 0.1) heading_.loosen(options_.gap_rate_sigma_rad_per_s * step_s);
}

void AttitudeFilter::remember(Time time) {
  history_.push_back({time, level_from_inertial_ * inertial_from_body_, turned_rad_});
  while ((time - history_.front().time).seconds() > kHistory_s) history_.pop_front();
}

void AttitudeFilter::add(const MagnetometerSample& sample) {
  if (!readings_) return;
  // The first readings only determine the unit. A single outlier among them would otherwise set the heading.
  constexpr int kForTheUnit = 2;
  const bool tells_unit = readings_for_unit_ < kForTheUnit;
  if (tells_unit) ++readings_for_unit_;
  for (const FieldSample& usable : readings_->add({&sample, 1})) {
    if (!tells_unit) waiting_.push_back(usable);
  }
  takeFields();
}

void AttitudeFilter::takeFields() {
  while (!waiting_.empty() && !history_.empty() && waiting_.front().time <= history_.back().time) {
    takeField(waiting_.front());
    waiting_.pop_front();
  }
}

void AttitudeFilter::takeField(const FieldSample& sample) {
  if (last_field_time_ && sample.time <= *last_field_time_) return;
  if (sample.time < history_.front().time) return;
  size_t after = history_.size() - 1;
  while (after > 0 && history_[after - 1].time >= sample.time) --after;
  const Moment& to = history_[after];
  const Moment& from = history_[after == 0 ? 0 : after - 1];
  const double span_s = (to.time - from.time).seconds();
  const double share = span_s > 0.0 ? (sample.time - from.time).seconds() / span_s : 1.0;
  const Quat level_from_body = from.level_from_body.slerp(share, to.level_from_body);

  const double since_s =
      last_field_time_ ? (sample.time - *last_field_time_).seconds() : 1.0 / magnetometer_rate_hz_;
  const double step_s = std::min(since_s, kLongestMagneticStepDetector_s);
  const Vec3 field_L = level_from_body * sample.field_B;
  const FieldVerdict verdict = gate_.update(field_L, to.turned_rad - last_field_turned_rad_, step_s);
  last_field_time_ = sample.time;
  last_field_turned_rad_ = to.turned_rad;
  // Angle that rotates the horizontal part of the field to magnetic north. Magnetic north is west of true
  // north by minus the declination.
  judge(verdict, std::atan2(field_L.x(), field_L.y()) - declination_rad_, step_s);
}

void AttitudeFilter::judge(FieldVerdict verdict, double measured_rad, double step_s) {
  // A disturbance of relative size d and random direction changes magnitude and dip together by d sqrt(2/3),
  // and the horizontal part sideways by d sqrt(1/3).
  const double horizontal_share = std::max(0.05, gate_.field().horizontal_T() / gate_.field().norm_T);
  const double field_error_rad =
      std::atan(std::numbers::sqrt2 / 2.0 * gate_.disturbance() / horizontal_share);
  const bool is_first = verdict == FieldVerdict::Settling && rejected_s_ == 0.0;
  const bool is_good = verdict == FieldVerdict::Good || is_first;
  if (is_good && heading_.accepts(measured_rad)) {
    heading_.correct(measured_rad, field_error_rad, false, step_s);
    status_ = HeadingStatus::Magnetic;
    rejected_s_ = 0.0;
    return;
  }
  rejected_s_ += step_s;
  if (rejected_s_ > options_.longest_rejection_s) {
    heading_.correct(measured_rad, field_error_rad, true, step_s);
    status_ = HeadingStatus::Readmitted;
  } else if (is_good) {
    status_ = HeadingStatus::WrongHeading;
  } else if (verdict != FieldVerdict::Settling) {
    status_ = verdict == FieldVerdict::WrongNorm ? HeadingStatus::WrongNorm : HeadingStatus::WrongDip;
  }
}

void AttitudeFilter::publish(Time time) {
  AttitudeEstimate estimate;
  estimate.time = time;
  estimate.world_from_body =
      so3::canonical(aboutUp(heading_.offset_rad()) * level_from_inertial_ * inertial_from_body_);
  estimate.heading_sigma_rad = heading_.sigma_rad();
  estimate.gyroscope_bias_B = bias_.bias_B();
  estimate.at_rest = at_rest_;
  if (last_field_time_ && (time - *last_field_time_).seconds() > kSilent_s) status_ = HeadingStatus::Waiting;
  estimate.status = status_;
  estimate_ = estimate;
}

}  // namespace lodeline
