#include "lodeline/inspection/start_check.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "lodeline/inspection/survey/excerpt_source.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

/// Number of images, which determine the duration of the check: pairs of every camera, distributed over seven
/// seconds, and a few others.
constexpr int kImagesOfPairs = 88;
constexpr int kMostSamples = 6;
constexpr double kPairInterval_s = 0.15;
/// Smallest offset of images to the gyroscope, or between cameras, that the run corrects.
constexpr double kLeastStartOffset_s = 0.015;

using Kinds = std::array<std::string_view, 3>;
constexpr Kinds kOfImagesAndGyroscope = {"axes_mirrored", "images_upside_down", "extrinsics_rotation"};
/// Harmful findings with which an estimate is still possible, or which end a run by themselves.
constexpr Kinds kOfOtherEnds = {"stream_empty", "image_size", "no_imu"};

bool isOneOf(const Kinds& kinds, const std::string& kind) {
  return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

/// Whether the run converts the readings of the finding.
bool isConverted(const InspectionFinding& finding, const Inspection& inspection) {
  return (finding.kind == "gyroscope_unit" && inspection.rate_to_SI != 1.0) ||
         (finding.kind == "accelerometer_unit" && inspection.imu.force_to_SI != 1.0);
}

/// Whether the rotation of a camera is so wrong that a run cannot estimate it.
bool isFarOff(const InspectionFinding& finding, const Inspection& inspection) {
  constexpr double kFar_rad = 20.0 * kDegree;
  return finding.kind == "extrinsics_rotation" &&
         std::any_of(inspection.cameras.begin(), inspection.cameras.end(),
                     [&](const CameraInspection& camera) {
                       return camera.survey.name == finding.sensor && camera.turning &&
                              camera.turning->misalignment_rad > kFar_rad;
                     });
}

/// Findings with which no estimate is possible: permuted axes, sensors without signal.
bool isHopeless(const InspectionFinding& finding, const Inspection& inspection) {
  constexpr double kHopeless = 85.0;
  if (isConverted(finding, inspection) || isOneOf(kOfOtherEnds, finding.kind)) return false;
  // The run skips the former and reverses the latter.
  if (finding.kind == "images_repeated" || finding.kind == "cameras_swapped") return false;
  return finding.harm >= kHopeless || isFarOff(finding, inspection);
}

const char* contradiction(const InspectionFinding& finding) {
  if (isOneOf(kOfImagesAndGyroscope, finding.kind)) return "images and gyroscope contradict each other";
  return finding.sensor.starts_with("cam") ? "images and calibration contradict each other"
                                           : "the inertial readings contradict each other";
}

/// Action of the run, in addition to the finding's own recommendation.
const char* remedy(const InspectionFinding& finding, const Inspection& inspection) {
  if (isConverted(finding, inspection)) return "; this run converts them";
  if (finding.kind == "cameras_swapped")
    return "; where exchanged images explain it, this run puts them back";
  if (finding.kind == "images_repeated") return "; this run leaves them out";
  if (finding.kind == kCameraTimeOffset) {
    return "; this run adds what it found to the images' stamps, where that is steady and more than 15 ms; "
           "poses "
           "keep the stamps as they were recorded";
  }
  return "";
}

void report(const InspectionFinding& finding, const Inspection& inspection, const std::string& hint,
            Diagnostics* diagnostics) {
  diagnostics->report(
      finding.severity, finding.kind,
      fmt::format("{}: {}{} ({})", finding.sensor, finding.message, remedy(finding, inspection), hint));
  if (!isHopeless(finding, inspection)) return;
  diagnostics->report(Severity::Serious, kSensorsContradict,
                      fmt::format("{} ({}, {}): the result is not to be trusted ({})", contradiction(finding),
                                  finding.sensor, finding.kind, hint));
}

bool isSecondary(const std::string& sensor, const Rig& rig) {
  return std::any_of(rig.cameras.begin(), rig.cameras.end(), [&](const CameraCalibration& camera) {
    return camera.name == sensor && &camera != &rig.cameras.front();
  });
}

/// Whether both halves of a camera's rotations have the same offset to the gyroscope. If a clock jumps
/// between them, the mean is wrong for both.
bool isSteady(const CameraInspection& camera) {
  constexpr double kSame_s = 0.008;
  return camera.turning_early && camera.turning_late &&
         std::abs(camera.turning_early->time_offset_s - camera.turning_late->time_offset_s) < kSame_s;
}

/// Offset of a camera to the gyroscope if it exceeds what the estimator compensates by itself; otherwise 0.
double shownOffset_s(const CameraInspection& camera, const Inspection& inspection) {
  const bool is_found = std::any_of(
      inspection.findings.begin(), inspection.findings.end(), [&](const InspectionFinding& finding) {
        return finding.kind == kCameraTimeOffset && finding.sensor == camera.survey.name;
      });
  const bool is_large = is_found && std::abs(camera.turning->time_offset_s) > kLeastStartOffset_s;
  return is_large && isSteady(camera) ? camera.turning->time_offset_s : 0.0;
}

/// Offsets of all cameras: a camera whose images lag behind those of the first one has its own offset,
/// otherwise both have the same.
std::vector<double> imageOffsets_s(const Inspection& inspection) {
  std::vector<double> offsets_s;
  for (const CameraInspection& camera : inspection.cameras) {
    const CameraInspection& first = inspection.cameras.front();
    const bool is_apart =
        camera.turning && first.turning && isSteady(camera) &&
        std::abs(camera.turning->time_offset_s - first.turning->time_offset_s) > kLeastStartOffset_s;
    const bool has_own = offsets_s.empty() || is_apart;
    offsets_s.push_back(has_own ? shownOffset_s(camera, inspection) : offsets_s.front());
  }
  return offsets_s;
}

}  // namespace

StartCheck checkStart(const SourceFactory& open, const std::string& data, const StartCheckOptions& options,
                      Diagnostics* diagnostics) {
  InspectionOptions looking;
  looking.images.most_turns = kImagesOfPairs;
  looking.images.most_samples = kMostSamples;
  looking.images.pair_interval_s = kPairInterval_s;
  const Inspection inspection = inspect(
      [&](Diagnostics* unheard) {
        return std::make_unique<ExcerptSource>(open(unheard), options.begin_s, options.length_s);
      },
      looking);
  // Without readings at the time of the images no comparison is possible; the run reports both spans.
  if (inspection.imu.stream.readings == 0) return {};
  const std::string hint =
      fmt::format("found in the first {:g} s; `lodeline inspect {}` says more", options.length_s, data);
  for (const InspectionFinding& finding : inspection.findings) {
    // The run screens its readings by itself, and compares the times of all images.
    if (inspection.imu.screening.count(finding.kind) > 0) continue;
    if (finding.kind == "stream_empty" && isSecondary(finding.sensor, inspection.rig)) continue;
    if (finding.severity == Severity::Serious || finding.kind == kIntrinsicsOdd)
      report(finding, inspection, hint, diagnostics);
  }
  return {imageOffsets_s(inspection), inspection.rate_to_SI, inspection.shown_noise};
}

}  // namespace lodeline
