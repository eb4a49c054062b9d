#include <fmt/format.h>

#include <cmath>

#include "lodeline/inspection/findings.h"
#include "lodeline/inspection/survey/signed_axes.h"
#include "lodeline/magnetometer/earth_field/world_magnetic_model.h"
#include "lodeline/util/angles.h"

namespace lodeline::findings {
namespace {

void addMagnetometerFinding(Inspection* inspection, Severity severity, double harm, const std::string& kind,
                            const std::string& message) {
  inspection->findings.push_back({severity, harm, "mag0", kind, message});
}

void judgeUnit(const MagnetometerSurvey& survey, Inspection* inspection) {
  if (survey.unit == FieldUnit::Tesla) return;
  if (survey.unit == FieldUnit::Raw) {
    addMagnetometerFinding(
        inspection, Severity::Serious, 75.0, "magnetometer_unit",
        fmt::format("the magnetometer's readings have a size of {:.3g}, which is the Earth's field in no "
                    "unit (22 to 67 uT): "
                    "raw counts, or iron beside the sensor",
                    survey.field_T));
    return;
  }
  addMagnetometerFinding(
      inspection, Severity::Serious, 76.0, "magnetometer_unit",
      fmt::format(
          "the magnetometer is in {}, not tesla (the field would be {:.3g} T); multiply its readings by {:g}",
          toString(survey.unit), survey.field_T / teslaPer(survey.unit), teslaPer(survey.unit)));
}

void judgeSite(const MagnetometerSurvey& survey, Inspection* inspection) {
  if (!inspection->site_field_W || survey.unit == FieldUnit::Raw) return;
  const FieldElements expected = fieldElements(*inspection->site_field_W);
  const double error = survey.field_T / expected.total_T - 1.0;
  if (std::abs(error) > 0.1) {
    addMagnetometerFinding(
        inspection, Severity::Warning, 42.0, "field_strength",
        fmt::format("the field has {:.1f} uT, but {:.1f} uT at this place: calibrate the magnetometer (iron "
                    "on the rig)",
                    1e6 * survey.field_T, 1e6 * expected.total_T));
  }
  if (!survey.inclination_rad) return;
  const double dip_error_deg = kDegreesPerRadian * (*survey.inclination_rad - expected.inclination_rad);
  if (std::abs(dip_error_deg) > 10.0) {
    addMagnetometerFinding(
        inspection, Severity::Warning, 41.0, "field_dip",
        fmt::format("the field points {:.0f} deg below the horizon, but {:.0f} deg at this place: calibrate "
                    "the magnetometer, "
                    "and check its axes",
                    kDegreesPerRadian * *survey.inclination_rad,
                    kDegreesPerRadian * expected.inclination_rad));
  }
}

/// There is no finding where no permutation of axes makes the field constant: the magnetometer is then
/// disturbed, or not calibrated.
void judgeTurning(const MagnetometerSurvey& survey, Inspection* inspection) {
  if (!survey.turning || survey.stream.frozen_share > 0.2) return;
  const FieldTurning& turning = *survey.turning;
  constexpr double kSteady = 0.1, kMuchBetter = 0.4, kMoving = 0.05;
  if (!turning.best_axes.isIdentity() && turning.scatter > kMoving && turning.best_scatter < kSteady &&
      turning.best_scatter < kMuchBetter * turning.scatter) {
    addMagnetometerFinding(
        inspection, Severity::Serious, 72.0, "magnetometer_axes",
        fmt::format("the axes of the magnetometer do not fit the gyroscope's: swapped, wrong signs or wrong "
                    "T_BS (in body axes as "
                    "if {}); the field scatters by {:.0f} %, {:.1f} % then",
                    describeSignedAxes(turning.best_axes), 100.0 * turning.scatter,
                    100.0 * turning.best_scatter));
    return;
  }
  constexpr double kHarmfulOffset_s = 0.03;
  if (std::abs(turning.time_offset_s) >= kHarmfulOffset_s &&
      turning.scatter_at_offset < 0.7 * turning.scatter) {
    addMagnetometerFinding(
        inspection, Severity::Warning, 46.0, "magnetometer_time_offset",
        fmt::format("time offset: the magnetometer's stamps {} the gyroscope's by about {:.0f} ms",
                    turning.time_offset_s < 0.0 ? "lag behind" : "run ahead of",
                    1e3 * std::abs(turning.time_offset_s)));
  }
}

}  // namespace

void judgeMagnetometer(Inspection* inspection) {
  if (!inspection->magnetometer || inspection->magnetometer->stream.readings == 0) return;
  const MagnetometerSurvey& survey = *inspection->magnetometer;
  judgeUnit(survey, inspection);
  judgeTurning(survey, inspection);
  judgeSite(survey, inspection);
}

}  // namespace lodeline::findings
