#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "lodeline/inspection/findings.h"
#include "lodeline/inspection/plausibility/odd_intrinsics.h"
#include "lodeline/inspection/survey/camera_words.h"

namespace lodeline::findings {
namespace {

/// Shares of the surveyed images.
constexpr double kManyImages = 0.25;
constexpr double kFewCorners = 40.0;

void add(const CameraSurvey& camera, Severity severity, double harm, const std::string& kind,
         const std::string& message, Inspection* inspection) {
  inspection->findings.push_back({severity, harm, camera.name, kind, message});
}

const char* advice(const std::string& word) {
  if (word == "dark") return "more light or longer exposure";
  if (word == "overexposed") return "shorter exposure or less light straight ahead";
  if (word == "blurred") return "shorter exposure, slower turns, or focus";
  return "clearer water, light from the side, or more distance from bare walls";
}

void judgeQuality(const CameraSurvey& camera, Inspection* inspection) {
  if (camera.frames.empty()) return;
  std::map<std::string, int> words;
  int few_corners = 0;
  for (const FrameSurvey& frame : camera.frames) {
    ++words[frame.quality.word];
    few_corners += frame.corners < kFewCorners ? 1 : 0;
  }
  const auto count = static_cast<double>(camera.frames.size());
  for (const auto& [word, frames] : words) {
    const double share = frames / count;
    // Faint texture is usual with lamps under water; the front end is made for it.
    if (word == "good" || word == "faint" || share < kManyImages) continue;
    add(camera, Severity::Warning, 35.0 + 10.0 * share, "images_" + word,
        fmt::format("{:.0f} % of the images are {}; {}", 100.0 * share, word, advice(word)), inspection);
  }
  const double share = few_corners / count;
  if (share > kManyImages) {
    add(camera, Severity::Warning, 36.0 + 10.0 * share, "few_features",
        fmt::format("{:.0f} % of the images have fewer than {:.0f} points worth following; the estimate will "
                    "drift there",
                    100.0 * share, kFewCorners),
        inspection);
  }
}

void judgeFiles(const CameraSurvey& camera, Inspection* inspection) {
  const int looked_at = static_cast<int>(camera.frames.size()) + camera.unreadable + camera.other_size;
  if (camera.unreadable > 0) {
    const double share = static_cast<double>(camera.unreadable) / looked_at;
    add(camera, share > 0.05 ? Severity::Serious : Severity::Warning, 50.0 + 40.0 * share,
        "images_unreadable",
        fmt::format("{} of {} images looked at are missing or damaged (first: {})", camera.unreadable,
                    looked_at, camera.first_problem),
        inspection);
  }
  if (camera.other_size > 0) {
    const auto calibration = std::find_if(inspection->rig.cameras.begin(), inspection->rig.cameras.end(),
                                          [&](const CameraCalibration& c) { return c.name == camera.name; });
    add(camera, Severity::Serious, 93.0, "image_size",
        fmt::format("images of {} x {} px, but the calibration is for {} x {} px: calibrate at the size that "
                    "is recorded",
                    camera.other_width_px, camera.other_height_px, calibration->width_px,
                    calibration->height_px),
        inspection);
  }
  if (camera.identical > 0) {
    const double share = static_cast<double>(camera.identical) / camera.compared;
    // Its effects look like a wrong focal length, delay or bias.
    add(camera, share > 0.02 ? Severity::Serious : Severity::Notice, 98.0, "images_repeated",
        fmt::format(
            "{} of {} images are the same, pixel by pixel, as the one before (first: stamp {} ns): the "
            "camera hangs, or a driver or converter fills up the frame rate. A run leaves them out; "
            "record at the rate of the camera",
            camera.identical, camera.compared, camera.first_identical->nanoseconds()),
        inspection);
  }
}

void judgeIntrinsics(const CameraSurvey& camera, Inspection* inspection) {
  for (const CameraCalibration& calibration : inspection->rig.cameras) {
    if (calibration.name != camera.name) continue;
    const OddIntrinsics odd = oddIntrinsics(calibration);
    if (odd.words.empty()) continue;
    add(camera, odd.is_explained ? Severity::Serious : Severity::Warning, odd.is_explained ? 86.0 : 58.0,
        kIntrinsicsOdd, "intrinsics: " + odd.words, inspection);
  }
}

/// Reports a camera that is upside down. A rig may be built so; no image shows the vertical.
void judgeUpright(Inspection* inspection) {
  if (inspection->imu.samples.empty() || inspection->cameras.empty()) return;
  const CameraCalibration& calibration = inspection->rig.cameras.front();
  if (!isCalibrated(calibration)) return;
  const Vec3 down_C = calibration.body_from_camera.rotation.conjugate() * -inspection->imu.up_B;
  constexpr double kUpsideDown = -0.8;
  if (down_C.y() > kUpsideDown) return;
  add(inspection->cameras.front().survey, Severity::Notice, 45.0, "upside_down",
      "gravity points to the top of the images: unless the camera is mounted upside down, T_BS is wrong or "
      "the accelerometer has the wrong sign (at rest it must read +9.8 m/s^2 upwards)",
      inspection);
}

}  // namespace

void judgeImages(Inspection* inspection) {
  judgeUpright(inspection);
  for (const CameraInspection& camera : inspection->cameras) {
    judgeFiles(camera.survey, inspection);
    judgeIntrinsics(camera.survey, inspection);
    judgeQuality(camera.survey, inspection);
  }
}

}  // namespace lodeline::findings
