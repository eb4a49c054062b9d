#include "lodeline/inspection/start_check.h"

#include <fmt/core.h>

#include <cmath>

#include "lodeline/inspection/excerpt_source.h"

namespace lodeline {
namespace {

/// Images are what the check costs: these take half a second of a core for each camera.
constexpr int kMostTurns = 36;
constexpr int kMostSamples = 6;
constexpr double kStep_s = 0.12;

/// Findings that harm so much leave nothing to estimate from: axes that are exchanged, dead sensors.
constexpr double kHopeless = 85.0;

/// What the run does about it, beside the finding's own advice.
std::string remedy(const InspectionFinding& finding) {
  if (finding.kind == "gyroscope_unit" || finding.kind == "accelerometer_unit") {
    return "this run converts the readings";
  }
  if (finding.kind == kCameraTimeOffset) {
    return "this run adds what it found to the images' stamps, as far as that is more than 15 ms";
  }
  return {};
}

/// Offsets beyond what the estimator takes care of by itself. A camera that shows none of its own has the
/// first one's.
std::vector<double> imageOffsets_s(const Inspection& inspection) {
  constexpr double kLeastOffset_s = 0.015;
  std::vector<double> offsets_s;
  for (const CameraInspection& camera : inspection.cameras) {
    double offset_s = offsets_s.empty() ? 0.0 : offsets_s.front();
    for (const InspectionFinding& finding : inspection.findings) {
      if (finding.kind != kCameraTimeOffset || finding.sensor != camera.survey.name) continue;
      if (std::abs(camera.turning->time_offset_s) > kLeastOffset_s) offset_s = camera.turning->time_offset_s;
    }
    offsets_s.push_back(offset_s);
  }
  return offsets_s;
}

}  // namespace

StartCheck checkStart(const SourceFactory& open, const std::string& data, const StartCheckOptions& options,
                      Diagnostics* diagnostics) {
  InspectionOptions looking;
  looking.images = {kMostTurns, kMostSamples, kStep_s};
  const Inspection inspection = inspect(
      [&](Diagnostics* unheard) {
        return std::make_unique<ExcerptSource>(open(unheard), options.begin_s, options.length_s);
      },
      looking);
  // Without readings at the time of the images there is nothing to compare; the run names both spans.
  if (inspection.imu.stream.readings == 0) return {};
  const std::string hint =
      fmt::format("found in the first {:g} s; `lodeline inspect {}` tells more", options.length_s, data);
  for (const InspectionFinding& finding : inspection.findings) {
    if (finding.severity != Severity::Serious) continue;
    const std::string done = remedy(finding);
    if (!done.empty()) {
      diagnostics->report(finding.severity, finding.kind,
                          fmt::format("{}: {}; {} ({})", finding.sensor, finding.message, done, hint));
    } else if (finding.harm < kHopeless) {
      diagnostics->report(finding.severity, finding.kind,
                          fmt::format("{}: {} ({})", finding.sensor, finding.message, hint));
    } else {
      const bool is_camera = finding.sensor.starts_with("cam");
      diagnostics->report(finding.severity, kSensorsContradict,
                          fmt::format("{}: {}: {}; the result is not to be trusted ({})",
                                      is_camera ? "images and gyroscope contradict each other"
                                                : "the inertial readings cannot be used",
                                      finding.sensor, finding.message, hint));
    }
  }
  return {imageOffsets_s(inspection), inspection.rate_to_SI, inspection.shown_noise};
}

}  // namespace lodeline
