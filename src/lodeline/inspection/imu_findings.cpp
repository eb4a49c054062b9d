#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lodeline/inspection/findings.h"
#include "lodeline/inspection/plausibility/rate_unit.h"
#include "lodeline/inspection/survey/signed_axes.h"
#include "lodeline/util/angles.h"

namespace lodeline::findings {
namespace {

constexpr double kGravity_m_per_s2 = 9.80665;

void addImuFinding(Inspection* inspection, Severity severity, double harm, const std::string& kind,
                   const std::string& message) {
  inspection->findings.push_back({severity, harm, "imu0", kind, message});
}

void judgeDead(const char* name, const char* kind, const TriadSurvey& triad, Inspection* inspection) {
  std::string axes;
  for (size_t axis = 0; axis < 3; ++axis) {
    if (triad.is_dead[axis]) axes += fmt::format("{}{}", axes.empty() ? "" : ", ", "xyz"[axis]);
  }
  if (axes.empty()) return;
  addImuFinding(inspection, Severity::Serious, 90.0, kind,
                fmt::format("the {}'s {} axis is dead: it never changes; nothing can be estimated with it",
                            name, axes));
}

/// `least_range`: smallest range of any sensor on the market. Coarse readings of a rig at rest may have the
/// same largest value many times.
void judgeSaturation(const char* name, const char* kind, const char* unit, double least_range,
                     const TriadSurvey& triad, Inspection* inspection) {
  if (triad.saturated_share < 1e-3 || triad.limit < least_range) return;
  addImuFinding(
      inspection, Severity::Warning, 55.0, kind,
      fmt::format("the {} is saturated in {:.2g} % of its readings (limit {:.4g} {}); choose a larger range",
                  name, 100.0 * triad.saturated_share, triad.limit, unit));
}

void judgeForceUnit(const ImuSurvey& imu, Inspection* inspection) {
  if (imu.force_to_SI != 1.0) {
    const char* unit = imu.force_to_SI > 1.0 ? "g" : "mg";
    addImuFinding(
        inspection, Severity::Serious, 98.0, "accelerometer_unit",
        fmt::format("the accelerometer is in {}, not m/s^2: its readings have a size of {:.4g}; multiply "
                    "them by {:.6g}",
                    unit, imu.median_force, imu.force_to_SI));
    return;
  }
  if (imu.median_force > 8.0 && imu.median_force < 12.5) return;
  addImuFinding(
      inspection, Severity::Serious, 97.0, "accelerometer_unit",
      fmt::format("the accelerometer's readings have a size of {:.4g} m/s^2, where gravity alone has 9.8: "
                  "wrong unit, "
                  "scale, or gravity taken off",
                  imu.median_force));
}

void judgeRest(const ImuSurvey& imu, Inspection* inspection) {
  if (imu.rest_s < 1.0) return;
  const double error = imu.rest_force_m_per_s2 - kGravity_m_per_s2;
  // Cheap accelerometers have up to 80 mg of bias when new, which the estimator estimates.
  constexpr double kWorthTelling_m_per_s2 = 0.25, kFaulty_m_per_s2 = 0.9;
  if (imu.force_to_SI == 1.0 && std::abs(error) > kWorthTelling_m_per_s2) {
    addImuFinding(
        inspection, std::abs(error) > kFaulty_m_per_s2 ? Severity::Warning : Severity::Notice, 45.0,
        "gravity_at_rest",
        fmt::format(
            "at rest the accelerometer reads {:.3f} m/s^2, {:.2f} off gravity; calibrate its scale and bias",
            imu.rest_force_m_per_s2, error));
  }
  constexpr double kLargeBias_rad_per_s = 0.12;
  if (imu.rest_rate_B.norm() * inspection->rate_to_SI > kLargeBias_rad_per_s) {
    addImuFinding(
        inspection, Severity::Warning, 44.0, "gyroscope_bias",
        fmt::format("at rest the gyroscope reads {:.2f} deg/s", kDegreesPerRadian * imu.rest_rate_B.norm()));
  }
}

/// Handedness and axes of the gyroscope compared with the accelerometer, without a camera.
void judgeTurningOfGravity(const ImuSurvey& imu, Inspection* inspection) {
  if (!imu.turning) return;
  const GravityTurning& turning = *imu.turning;
  constexpr double kClear = 0.75;
  if (turning.best_correlation < kClear || turning.correlation > 0.3 * turning.best_correlation) return;
  const bool is_mirrored = turning.correlation < -kClear;
  addImuFinding(
      inspection, Severity::Serious, is_mirrored ? 92.0 : 85.0, "imu_axes",
      is_mirrored
          ? std::string(
                "the axes of the IMU are swapped: they form a left-handed frame (gravity turns against the "
                "gyroscope); two axes are exchanged or one or three have the wrong sign")
          : fmt::format("the axes of gyroscope and accelerometer differ, swapped or with wrong signs: "
                        "gravity turns as if, "
                        "in the gyroscope's readings, {}",
                        describeSignedAxes(turning.best_axes)));
}

void judgeAlternation(const ImuSurvey& imu, Inspection* inspection) {
  if (imu.alternation_m_per_s2 == 0.0) return;
  addImuFinding(
      inspection, Severity::Serious, 96.0, "imu_interleaved",
      fmt::format("two sensors: every other reading of the accelerometer differs from those between by "
                  "{:.2g} m/s^2, all the time; the readings of two IMUs, or of a raw and a filtered "
                  "stream, take turns. Write each to its stream",
                  imu.alternation_m_per_s2));
}

/// Readings that a run would skip or convert.
void judgeScreening(const ImuSurvey& imu, Inspection* inspection) {
  for (const Finding& finding : imu.screening.ranked()) {
    const std::string times = finding.count > 1 ? fmt::format(" ({} times)", finding.count) : std::string();
    addImuFinding(inspection, finding.severity, 57.0, finding.kind, finding.first_message + times);
  }
}

/// Comparison of the calibration's noise densities with those of the readings.
void judgeNoise(Inspection* inspection) {
  std::vector<ImuSample> samples = inspection->imu.samples;
  for (ImuSample& sample : samples) sample.angular_velocity_B *= inspection->rate_to_SI;
  inspection->shown_noise = whiteNoiseOf(samples);
  Diagnostics judgement;
  plausibleNoise(inspection->rig.imu.noise, inspection->shown_noise, &judgement);
  for (const Finding& finding : judgement.ranked()) {
    addImuFinding(inspection, finding.severity, 56.0, finding.kind, finding.first_message);
  }
}

/// Vibration of motors, where it is far above the noise that the calibration states.
void judgeVibration(Inspection* inspection) {
  constexpr double kTimes = 5.0, kLeastForce_m_per_s2 = 0.05, kLeastRate_rad_per_s = 0.005, kOften = 0.1;
  const ImuNoise& noise = inspection->rig.imu.noise;
  std::vector<ImuSample> samples = inspection->imu.samples;
  for (ImuSample& sample : samples) sample.angular_velocity_B *= inspection->rate_to_SI;
  const auto judge = [&](Vec3 ImuSample::*reading, double density, double least, const char* sensor,
                         const char* unit) {
    const double stated = density * std::sqrt(std::max(inspection->imu.stream.rate_hz, 1.0));
    const Vibration vibration = surveyVibration(samples, reading, std::max(kTimes * stated, least));
    if (vibration.share < kOften) return vibration;
    addImuFinding(
        inspection, Severity::Notice, 43.0, "imu_vibration",
        fmt::format(
            "the {} vibrates in {:.0f} % of the time: {:.3g} {}, {:.0f} times its stated noise, strongest "
            "at {:.0f} Hz or at a frequency that {:.0f} readings a second show there; mount the IMU softly, "
            "or record it faster with its filter on",
            sensor, 100.0 * vibration.share, vibration.strong, unit, vibration.strong / stated,
            vibration.frequency_hz, vibration.rate_hz));
    return vibration;
  };
  inspection->force_vibration =
      judge(&ImuSample::specific_force_B, noise.accelerometer_density_m_per_s2_sqrtHz, kLeastForce_m_per_s2,
            "accelerometer", "m/s^2");
  inspection->rate_vibration = judge(&ImuSample::angular_velocity_B, noise.gyroscope_density_rad_per_s_sqrtHz,
                                     kLeastRate_rad_per_s, "gyroscope", "rad/s");
}

/// Unit of the rates without a camera: gravity rotates far more slowly than, for example, rates in deg/s read
/// as rad/s.
void judgeRateUnit(const ImuSurvey& imu, Inspection* inspection) {
  // Motion adds to gravity: the less clear the relation, the more vague is its scale.
  constexpr double kVague = 0.4, kClear = 0.6, kLikeness = 2.5, kClearLikeness = 1.6;
  if (inspection->rate_to_SI != 1.0 || !imu.turning || imu.turning->correlation < kVague) return;
  const double scale = imu.turning->scale;
  const bool is_clear = imu.turning->correlation > kClear;
  std::optional<RateUnit> unit = rateUnitOf(scale, kLikeness);
  if (unit && unit->to_SI != kDegree) unit = is_clear ? rateUnitOf(scale, kClearLikeness) : std::nullopt;
  if (!unit) return;
  inspection->rate_to_SI = unit->to_SI;
  addImuFinding(
      inspection, Severity::Serious, 99.0, "gyroscope_unit",
      fmt::format("the gyroscope is in {}, not rad/s: gravity turns {:.3g} times as fast as it says; "
                  "multiply its readings by {:.6g}",
                  unit->name, scale, unit->to_SI));
}

}  // namespace

void judgeImu(Inspection* inspection) {
  const ImuSurvey& imu = inspection->imu;
  if (imu.samples.empty()) return;
  judgeDead("gyroscope", "gyroscope_dead_axis", imu.gyroscope, inspection);
  judgeDead("accelerometer", "accelerometer_dead_axis", imu.accelerometer, inspection);
  constexpr double kLeastRate_rad_per_s = 2.0, kLeastForce_m_per_s2 = 18.0;
  judgeSaturation("gyroscope", "gyroscope_saturated", "rad/s", kLeastRate_rad_per_s / inspection->rate_to_SI,
                  imu.gyroscope, inspection);
  judgeSaturation("accelerometer", "accelerometer_saturated", "m/s^2", kLeastForce_m_per_s2 / imu.force_to_SI,
                  imu.accelerometer, inspection);
  judgeForceUnit(imu, inspection);
  judgeAlternation(imu, inspection);
  judgeRateUnit(imu, inspection);
  judgeRest(imu, inspection);
  judgeTurningOfGravity(imu, inspection);
  judgeScreening(imu, inspection);
  judgeNoise(inspection);
  judgeVibration(inspection);
}

}  // namespace lodeline::findings
