#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lodeline/inspection/findings.h"
#include "lodeline/inspection/survey/signed_axes.h"
#include "lodeline/util/angles.h"

namespace lodeline::findings {
namespace {

void addRobotFinding(Inspection* inspection, Severity severity, double harm, const std::string& sensor,
                     const std::string& kind, const std::string& message) {
  inspection->findings.push_back({severity, harm, sensor, kind, message});
}

/// DVL against IMU. Errors of the attitude and of a consumer's accelerometer stay in the remainder.
void judgeDvl(const DvlComparison& dvl, Inspection* inspection) {
  constexpr double kLeastMotion_m_per_s = 0.05, kFits = 0.5, kContradicts = 0.7, kMuchBetter = 0.6;
  if (dvl.motion_m_per_s < kLeastMotion_m_per_s) return;
  const double remainder = dvl.remainder_m_per_s / dvl.motion_m_per_s;
  const double best = dvl.best_remainder_m_per_s / dvl.motion_m_per_s;
  const double moved = dvl.remainder_at_offset_m_per_s / dvl.motion_m_per_s;
  if (remainder > kContradicts && best < kFits && best < kMuchBetter * remainder) {
    addRobotFinding(
        inspection, Severity::Serious, 74.0, "dvl0", "dvl_axes",
        fmt::format("the axes of the DVL do not fit the IMU's: swapped, wrong signs or wrong T_BS (in body "
                    "axes as if "
                    "{}); {:.0f} % of the change of velocity is left, {:.0f} % then",
                    describeSignedAxes(dvl.best_axes), 100.0 * remainder, 100.0 * best));
    return;
  }
  constexpr double kHarmfulOffset_s = 0.1, kClearlyBetter = 0.8;
  if (std::abs(dvl.time_offset_s) < kHarmfulOffset_s || moved > kClearlyBetter * remainder || moved > kFits)
    return;
  addRobotFinding(
      inspection, Severity::Warning, 58.0, "dvl0", "dvl_time_offset",
      fmt::format(
          "the stamps of the DVL fit the IMU better with {:+.2f} s: write this as `timeshift` of dvl0",
          dvl.time_offset_s + inspection->rig.dvl->time_offset_to_imu_s));
}

/// DVL against images. Their directions are good to some degrees, less where the camera looks along its way.
void judgeDvlImages(const DvlImageComparison& dvl, Inspection* inspection) {
  constexpr double kContradicts_rad = 40.0 * kDegree, kFits_rad = 25.0 * kDegree, kMuchBetter = 0.5;
  const auto has = [&](const char* kind) {
    return std::any_of(inspection->findings.begin(), inspection->findings.end(),
                       [&](const InspectionFinding& finding) { return finding.kind == kind; });
  };
  if (!has("dvl_axes") && dvl.angle_rad > kContradicts_rad && dvl.best_angle_rad < kFits_rad &&
      dvl.best_angle_rad < kMuchBetter * dvl.angle_rad) {
    addRobotFinding(
        inspection, Severity::Serious, 74.0, "dvl0", "dvl_axes",
        fmt::format(
            "the DVL moves in another direction than the images: swapped axes or beams, wrong signs or "
            "wrong T_BS (in body axes as if {}); {:.0f} degrees apart, {:.0f} then",
            describeSignedAxes(dvl.best_axes), kDegreesPerRadian * dvl.angle_rad,
            kDegreesPerRadian * dvl.best_angle_rad));
    return;
  }
  constexpr double kHarmful_s = 0.1, kBetter = 0.7, kNoise_rad = 3.0 * kDegree;
  if (has("dvl_axes") || has("dvl_time_offset") || std::abs(dvl.time_offset_s) < kHarmful_s ||
      dvl.angle_at_offset_rad > kFits_rad ||
      dvl.angle_at_offset_rad > std::min(kBetter * dvl.angle_rad, dvl.angle_rad - kNoise_rad))
    return;
  addRobotFinding(
      inspection, Severity::Warning, 58.0, "dvl0", "dvl_time_offset",
      fmt::format(
          "the stamps of the DVL fit the images better with {:+.2f} s: write this as `timeshift` of dvl0",
          dvl.time_offset_s + inspection->rig.dvl->time_offset_to_imu_s));
}

/// The channel whose field in the rig is that of `shown`; nothing where there is none.
std::optional<size_t> channelWith(const Vec3& shown, const CurrentCalibration& currents) {
  constexpr double kSame = 0.3;
  for (size_t i = 0; i < currents.fields_T_per_A.size(); ++i) {
    if ((currents.fields_T_per_A[i] - shown).norm() < kSame * shown.norm()) return i;
  }
  return std::nullopt;
}

void judgeChannel(const ChannelField& shown, const Vec3& calibrated, Inspection* inspection) {
  constexpr double kSignificant_sigmas = 6.0, kSame = 0.5;
  const double size = shown.field_T_per_A.norm();
  if (size < kSignificant_sigmas * shown.sigma_T_per_A) return;
  if ((shown.field_T_per_A - calibrated).norm() < kSame * std::max(size, calibrated.norm())) return;
  const std::string figures = fmt::format("{}: the readings show {:.3g} uT/A, the rig states {:.3g} uT/A",
                                          shown.name, 1e6 * size, 1e6 * calibrated.norm());
  if ((shown.field_T_per_A + calibrated).norm() < kSame * size) {
    addRobotFinding(inspection, Severity::Serious, 71.0, "current0", "current_sign",
                    figures + " with the opposite sign; check the sign of the current");
    return;
  }
  const CurrentCalibration& currents = *inspection->rig.currents;
  if (const std::optional<size_t> other = channelWith(shown.field_T_per_A, currents)) {
    addRobotFinding(
        inspection, Severity::Serious, 71.5, "current0", "current_channels",
        fmt::format("{}; it is the field of {}: channels are exchanged", figures, currents.channels[*other]));
    return;
  }
  addRobotFinding(
      inspection, Severity::Warning, 57.0, "current0", "current_field",
      figures + " in another direction or size; calibrate the currents again, because cables moved");
}

void judgeCurrents(const CurrentComparison& comparison, Inspection* inspection) {
  const CurrentCalibration& currents = *inspection->rig.currents;
  for (const ChannelField& shown : comparison.channels) {
    for (size_t i = 0; i < currents.fields_T_per_A.size(); ++i) {
      if (currents.channels[i] == shown.name) judgeChannel(shown, currents.fields_T_per_A[i], inspection);
    }
  }
  constexpr double kHarmfulOffset_s = 0.1, kClearlyBetter = 0.8;
  if (std::abs(comparison.time_offset_s) < kHarmfulOffset_s ||
      comparison.scatter_at_offset_T > kClearlyBetter * comparison.explained_scatter_T)
    return;
  addRobotFinding(
      inspection, Severity::Warning, 56.0, "current0", "current_time_offset",
      fmt::format("the stamps of the currents fit the magnetometer better with {:+.2f} s: write this as "
                  "`timeshift` of "
                  "current0",
                  comparison.time_offset_s + currents.time_offset_to_imu_s));
}

}  // namespace

void judgeRobotSensors(Inspection* inspection) {
  if (inspection->dvl) judgeDvl(*inspection->dvl, inspection);
  if (inspection->dvl_images) judgeDvlImages(*inspection->dvl_images, inspection);
  if (inspection->currents) judgeCurrents(*inspection->currents, inspection);
}

}  // namespace lodeline::findings
