#include "lodeline/inspection/inspection.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lodeline/inspection/findings.h"
#include "lodeline/inspection/other_sensors.h"
#include "lodeline/inspection/plausibility/rate_unit.h"
#include "lodeline/inspection/survey/camera_words.h"

namespace lodeline {
namespace {

/// Adds errors in the order of the time stamps that the other functions do not find.
void takeOrderFindings(const Diagnostics& diagnostics, const std::string& sensor, Inspection* inspection) {
  for (const Finding& finding : diagnostics.ranked()) {
    if (!finding.kind.ends_with("_clock_jump") && !finding.kind.ends_with("_bursts")) continue;
    const Severity severity = finding.kind.ends_with("_clock_jump") ? Severity::Serious : Severity::Warning;
    inspection->findings.push_back({severity, 78.0, sensor, finding.kind, finding.first_message});
  }
}

std::vector<StreamSummary> readStreams(MeasurementSource* source, Inspection* inspection) {
  inspection->rig = source->rig();
  Diagnostics imu_order;
  inspection->imu = surveyImu(source, &imu_order);
  takeOrderFindings(imu_order, "imu0", inspection);
  inspection->others = surveyOtherSensors(source);
  std::vector<StreamSummary> images;
  for (size_t i = 0; i < inspection->rig.cameras.size(); ++i) {
    Diagnostics image_order;
    images.push_back(surveyStamps(source, i, &image_order));
    takeOrderFindings(image_order, inspection->rig.cameras[i].name, inspection);
  }
  return images;
}

/// Determines the unit of the gyroscope's rates from the images of the first camera.
void settleRateUnit(Inspection* inspection) {
  constexpr double kLikeness = 2.0, kSame = 0.6;
  for (const CameraInspection& camera : inspection->cameras) {
    if (!camera.turning || camera.turning->correlation < kSame) continue;
    const double scale = camera.turning->gyroscope_scale;
    const std::optional<RateUnit> unit = rateUnitOf(scale, kLikeness);
    if (!unit) return;
    inspection->rate_to_SI = unit->to_SI;
    inspection->findings.push_back(
        {Severity::Serious, 99.0, "imu0", "gyroscope_unit",
         fmt::format("the gyroscope is in {}, not rad/s: the images turn {:.3g} times as fast as it says; "
                     "multiply its readings by {:.6g}",
                     unit->name, scale, unit->to_SI)});
    return;
  }
}

void compareCameras(Inspection* inspection) {
  std::vector<ImuSample> samples = inspection->imu.samples;
  for (ImuSample& sample : samples) sample.angular_velocity_B *= inspection->rate_to_SI;
  const GyroscopeIntegral gyroscope(samples);
  for (size_t i = 0; i < inspection->cameras.size(); ++i) {
    CameraInspection& camera = inspection->cameras[i];
    const Quat& body_from_camera = inspection->rig.cameras[i].body_from_camera.rotation;
    const std::vector<CameraTurn>& turns = camera.survey.turns;
    const auto middle = turns.begin() + static_cast<std::ptrdiff_t>(turns.size() / 2);
    camera.turning = compareTurns(turns, gyroscope, body_from_camera);
    // A change of the offset must be significant. An offset of seconds is that of both halves.
    constexpr double kSeconds_s = 1.0;
    const double offset_s = camera.turning ? camera.turning->time_offset_s : 0.0;
    const TurnLimits half = {12, 3.0, std::abs(offset_s) > kSeconds_s ? offset_s : 0.0, false};
    camera.turning_early = compareTurns({turns.begin(), middle}, gyroscope, body_from_camera, half);
    camera.turning_late = compareTurns({middle, turns.end()}, gyroscope, body_from_camera, half);
  }
}

void lookAtImages(const SourceFactory& open, const std::vector<StreamSummary>& images,
                  const InspectionOptions& options, Inspection* inspection) {
  if (images.empty()) return;
  Diagnostics reported_before;
  const std::unique_ptr<MeasurementSource> source = open(&reported_before);
  const double period_s = images.front().rate_hz > 0.0 ? 1.0 / images.front().rate_hz : 0.05;
  const double total_s = options.images.most_turns * std::max({options.images.least_step_s, period_s,
                                                               0.5 * options.images.pair_interval_s});
  const std::vector<SurveySpan> spans =
      liveliestSpans(inspection->imu.samples, images.front(), options.span_s, total_s);
  const double cameras = static_cast<double>(images.size());
  for (size_t i = 0; i < images.size(); ++i) {
    options.progress(0.2 + 0.5 * static_cast<double>(i) / cameras);
    inspection->cameras.push_back(
        {surveyCamera(source.get(), i, images[i], spans, options.images), {}, {}, {}});
  }
  options.progress(0.7);
  if (images.size() > 1 && isCalibrated(inspection->rig.cameras[0]) &&
      isCalibrated(inspection->rig.cameras[1])) {
    Diagnostics also_reported_before;
    inspection->stereo = surveyStereo(open(&also_reported_before).get(), images.front());
  }
  compareCameras(inspection);
  settleRateUnit(inspection);
  if (inspection->rate_to_SI != 1.0) compareCameras(inspection);
}

void takeReaderFindings(const Diagnostics& diagnostics, Inspection* inspection) {
  for (const Finding& finding : diagnostics.ranked()) {
    if (finding.kind == "magnetometer_unit") continue;  // reported here with the name of the unit
    const std::string times = finding.count > 1 ? " (" + std::to_string(finding.count) + " times)" : "";
    inspection->findings.push_back(
        {finding.severity, 48.0, "recording", finding.kind, finding.first_message + times});
  }
}

}  // namespace

std::string Inspection::verdict(const std::string& sensor) const {
  Severity worst = Severity::Notice;
  for (const InspectionFinding& finding : findings) {
    if (finding.sensor == sensor) worst = std::max(worst, finding.severity);
  }
  if (worst == Severity::Serious) return "harmful";
  return worst == Severity::Warning ? "usable" : "good";
}

Inspection inspect(const SourceFactory& open, const InspectionOptions& options) {
  Inspection inspection;
  inspection.site_field_W = options.site_field_W;
  Diagnostics diagnostics;
  const std::unique_ptr<MeasurementSource> source = open(&diagnostics);
  const std::vector<StreamSummary> images = readStreams(source.get(), &inspection);
  lookAtImages(open, images, options, &inspection);
  options.progress(0.9);
  findings::judgeImu(&inspection);
  if (inspection.rig.magnetometer) {
    std::vector<ImuSample> samples = inspection.imu.samples;
    for (ImuSample& sample : samples) sample.angular_velocity_B *= inspection.rate_to_SI;
    inspection.magnetometer = surveyMagnetometer(source.get(), samples);
  }
  if (!inspection.imu.samples.empty()) compareRobotSensors(open, &inspection);
  findings::judgeStreams(&inspection);
  findings::judgeImages(&inspection);
  findings::judgeExtrinsics(&inspection);
  findings::judgeTurning(&inspection);
  findings::judgeMagnetometer(&inspection);
  findings::judgeRobotSensors(&inspection);
  takeReaderFindings(diagnostics, &inspection);
  std::stable_sort(inspection.findings.begin(), inspection.findings.end(),
                   [](const InspectionFinding& a, const InspectionFinding& b) {
                     return a.severity != b.severity ? a.severity > b.severity : a.harm > b.harm;
                   });
  return inspection;
}

}  // namespace lodeline
