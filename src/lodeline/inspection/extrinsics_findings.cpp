#include <fmt/format.h>

#include <string>

#include "lodeline/inspection/findings.h"
#include "lodeline/util/angles.h"

namespace lodeline::findings {
namespace {

/// Longer than any rig of one diver or small vehicle, m.
constexpr double kLongest_m = 5.0;
/// Shorter than the distance between two lenses can be, m.
constexpr double kShortest_m = 5e-3;

void judgeLeverArm(const std::string& sensor, const Rigid3& body_from_sensor, Inspection* inspection) {
  const double length_m = body_from_sensor.translation.norm();
  if (length_m < kLongest_m) return;
  inspection->findings.push_back(
      {Severity::Serious, 89.0, sensor, "extrinsics_unit",
       fmt::format("extrinsics: T_BS puts the sensor {:.4g} m from the IMU; is it in mm? It must be in m",
                   length_m)});
}

void judgeBaseline(const StereoSurvey& stereo, const std::string& sensor, Inspection* inspection) {
  if (stereo.baseline_m >= kShortest_m && stereo.baseline_m < kLongest_m) return;
  inspection->findings.push_back(
      {Severity::Serious, 89.5, sensor, "baseline",
       fmt::format("extrinsics: the baseline from cam0 to {} is {:.4g} m by their T_BS, which no rig has: "
                   "wrong unit (m, not mm), or the same T_BS twice",
                   sensor, stereo.baseline_m)});
}

void judgeCopies(const StereoSurvey& stereo, const std::string& sensor, Inspection* inspection) {
  if (stereo.same == 0 || 2 * stereo.same < stereo.images) return;
  inspection->findings.push_back(
      {Severity::Serious, 88.0, sensor, "cameras_same",
       fmt::format("images: {} of {} images of {} are copies of those of cam0: the same topic, folder or "
                   "video twice? "
                   "Give each camera its images, or use one camera (`--set source.cameras=[0]`)",
                   stereo.same, stereo.images, sensor)});
}

const char* describe(StereoHypothesis hypothesis) {
  switch (hypothesis) {
    case StereoHypothesis::ImagesExchanged:
      return "if the images of one are those of the other";
    case StereoHypothesis::ExtrinsicsExchanged:
      return "if the T_BS of one is that of the other";
    case StereoHypothesis::ExtrinsicsInverted:
      return "if both T_BS are inverted (they are to take camera coordinates to those of the body)";
    default:
      return "if the way from one to the other has the opposite sign";
  }
}

void judgePair(const StereoSurvey& stereo, const std::string& sensor, Inspection* inspection) {
  constexpr int kLeastPoints = 60;
  constexpr double kContradicts = 0.3, kFits = 0.7;
  if (stereo.points < kLeastPoints || stereo.agreement > kContradicts || stereo.best_agreement < kFits)
    return;
  std::string readings;
  for (const StereoHypothesis hypothesis : stereo.fitting) {
    readings += (readings.empty() ? "" : ", or ") + std::string(describe(hypothesis));
  }
  const bool is_inverted =
      stereo.fitting == std::vector<StereoHypothesis>{StereoHypothesis::ExtrinsicsInverted};
  inspection->findings.push_back(
      {Severity::Serious, 87.0, sensor, is_inverted ? "extrinsics_inverted" : "cameras_swapped",
       fmt::format("extrinsics: {}: {:.0f} % of the points that cam0 and {} both see lie off their epipolar "
                   "lines or behind the cameras; {:.0f} % fit {}",
                   is_inverted ? "T_BS inverted" : "left and right camera swapped",
                   100.0 * (1.0 - stereo.agreement), sensor, 100.0 * stereo.best_agreement, readings)});
}

void judgeTurn(const StereoSurvey& stereo, const std::string& sensor, Inspection* inspection) {
  constexpr double kAgrees = 0.5;  // a smaller agreement has further causes
  if (stereo.turn_rad == 0.0 || stereo.agreement < kAgrees) return;
  inspection->findings.push_back(
      {Severity::Warning, 60.0, sensor, "camera_turned",
       fmt::format("extrinsics: points that cam0 and {} both see lie off their epipolar lines as if {} were "
                   "turned by {:.2f} degrees against its T_BS; a run finds it out and goes on, but calibrate "
                   "the pair anew",
                   sensor, sensor, stereo.turn_rad * kDegreesPerRadian)});
}

}  // namespace

void judgeExtrinsics(Inspection* inspection) {
  const Rig& rig = inspection->rig;
  for (const CameraCalibration& camera : rig.cameras) {
    judgeLeverArm(camera.name, camera.body_from_camera, inspection);
  }
  if (rig.magnetometer) judgeLeverArm("mag0", rig.magnetometer->body_from_magnetometer, inspection);
  if (rig.pressure) judgeLeverArm("pressure0", rig.pressure->body_from_pressure, inspection);
  if (rig.sonar) judgeLeverArm("sonar0", rig.sonar->body_from_sonar, inspection);
  if (rig.altimeter) judgeLeverArm("altimeter0", rig.altimeter->body_from_sonar, inspection);
  if (rig.dvl) judgeLeverArm("dvl0", rig.dvl->body_from_dvl, inspection);
  if (!inspection->stereo) return;
  judgeBaseline(*inspection->stereo, rig.cameras[1].name, inspection);
  judgeCopies(*inspection->stereo, rig.cameras[1].name, inspection);
  judgePair(*inspection->stereo, rig.cameras[1].name, inspection);
  judgeTurn(*inspection->stereo, rig.cameras[1].name, inspection);
}

}  // namespace lodeline::findings
