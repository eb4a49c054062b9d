#include "lodeline/magnetometer/calibration/heading/axis_checks.h"

#include <fmt/format.h>

#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/magnetometer/earth_field/world_magnetic_model.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

/// Ratio of the disagreements of readings and opposite readings that indicates a wrong sign.
constexpr double kMuchBetter = 3.0;
constexpr double kDistinct = 4.0;
/// Maximum rotation between the axes of accelerometer and gyroscope. With correct signs, only hand
/// accelerations cause a difference.
constexpr double kGreatestGravityTurn_rad = 45.0 * kDegree;
constexpr double kGreatestMountingError_rad = 20.0 * kDegree;
/// Minimum dip; nearer to the magnetic equator, the sign of the dip is not significant.
constexpr double kTellingDip_rad = 10.0 * kDegree;

std::vector<ImuSample> turnedTheOtherWay(std::span<const ImuSample> imu) {
  std::vector<ImuSample> turned(imu.begin(), imu.end());
  for (ImuSample& sample : turned) sample.angular_velocity_B *= -1.0;
  return turned;
}

/// Directions of the specific force, smoothed over the accelerations of the hand.
std::vector<NormalizedFieldSample> gravityDirections(std::span<const ImuSample> imu) {
  constexpr double kInterval_s = 0.05;
  std::vector<NormalizedFieldSample> directions;
  Vec3 sum = Vec3::Zero();
  Time begin = imu.front().time;
  for (const ImuSample& sample : imu) {
    sum += sample.specific_force_B;
    if ((sample.time - begin).seconds() < kInterval_s) continue;
    directions.push_back(
        {begin + Duration::fromSeconds(0.5 * (sample.time - begin).seconds()), sum.normalized()});
    sum.setZero();
    begin = sample.time;
  }
  return directions;
}

}  // namespace

std::optional<std::string> gyroscopeObjection(std::span<const NormalizedFieldSample> field,
                                              const FieldAlignment& alignment,
                                              std::span<const ImuSample> imu) {
  const std::optional<FieldAlignment> reversed = alignField(field, turnedTheOtherWay(imu));
  if (reversed && reversed->distinctness >= kDistinct &&
      kMuchBetter * reversed->residual < alignment.residual) {
    return "the gyroscope turns the other way round than the field: one or all signs of its axes are "
           "reversed, "
           "or two axes are exchanged";
  }
  const std::vector<NormalizedFieldSample> gravity = gravityDirections(imu);
  FieldAlignmentOptions options;
  options.greatest_time_offset_s = 0.0;
  const std::optional<FieldAlignment> by_gravity = alignField(gravity, imu, options);
  if (!by_gravity || by_gravity->distinctness < kDistinct) return std::nullopt;
  const double turn_rad = by_gravity->body_from_magnetometer.angularDistance(Quat::Identity());
  if (turn_rad < kGreatestGravityTurn_rad) return std::nullopt;
  return fmt::format(
      "the axes of gyroscope and accelerometer are {:.0f} degrees apart: signs of two axes are reversed, or "
      "axes "
      "are exchanged, in one of them",
      turn_rad / kDegree);
}

void reportNegativeDip(double dip_rad, Diagnostics* diagnostics) {
  if (dip_rad > -kTellingDip_rad) return;
  diagnostics->report(
      Severity::Warning, "magnetometer_reversed",
      fmt::format("the measured field dips by {:.1f} degrees, as it does south of the magnetic equator. "
                  "North of it the magnetometer's axes are left-handed or of reversed sign (or the "
                  "accelerometer's are), and headings are off by up to 180 degrees; --site and --date tell",
                  dip_rad / kDegree));
}

void checkAxes(const MagnetometerFit& fit, const std::optional<Vec3>& site_field_ENU,
               const std::optional<Quat>& stated_body_from_magnetometer, Diagnostics* diagnostics) {
  if (fit.body_from_magnetometer && stated_body_from_magnetometer) {
    const double turn_rad = fit.body_from_magnetometer->angularDistance(*stated_body_from_magnetometer);
    if (turn_rad > kGreatestMountingError_rad) {
      diagnostics->report(
          Severity::Warning, "magnetometer_rotation",
          fmt::format(
              "the magnetometer's axes are {:.0f} degrees from where the recording's T_BS has them: the "
              "mounting is another, or axes are exchanged or reversed; the calibration holds what was "
              "found",
              turn_rad / kDegree));
    }
  }
  if (!fit.dip_rad || std::abs(*fit.dip_rad) < kTellingDip_rad) return;
  if (!site_field_ENU) return reportNegativeDip(*fit.dip_rad, diagnostics);
  const double site_dip_rad = fieldElements(*site_field_ENU).inclination_rad;
  if (std::abs(site_dip_rad) < kTellingDip_rad || site_dip_rad * *fit.dip_rad > 0.0) return;
  throw EstimationError(
      fmt::format("the field dips by {:.1f} degrees where the site's dips by {:.1f}: the magnetometer's axes "
                  "are left-handed "
                  "or of reversed sign (or the accelerometer's are), and headings would be off by up to 180 "
                  "degrees. Exchange "
                  "two axes back or turn their signs, in the recordings too, and calibrate again",
                  *fit.dip_rad / kDegree, site_dip_rad / kDegree));
}

}  // namespace lodeline
