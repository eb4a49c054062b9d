#include <fmt/format.h>

#include <cmath>

#include "lodeline/geometry/so3.h"
#include "lodeline/inspection/findings.h"
#include "lodeline/inspection/survey/signed_axes.h"
#include "lodeline/util/angles.h"

namespace lodeline::findings {
namespace {

/// Smallest correlation at which the rotations of camera and gyroscope count as the same motion.
constexpr double kSame = 0.6;
/// Smallest correlation at which their differences count as errors of the rig and not of the images.
constexpr double kJudgeable = 0.93;
constexpr double kHarmfulOffset_s = 0.008;
/// The offsets of the halves are less accurate than that of all rotations.
constexpr double kHarmfulChange_s = 0.015;
constexpr double kHarmfulMisalignment_rad = 5.0 / kDegreesPerRadian;
constexpr double kHarmfulFocalError = 0.1;
constexpr double kSignificant_sigmas = 4.0;

class TurningJudge {
 public:
  TurningJudge(const CameraInspection& camera, const CameraCalibration& calibration, Inspection* inspection)
      : name_(camera.survey.name),
        camera_(camera),
        calibration_(calibration),
        turning_(*camera.turning),
        inspection_(inspection) {}

  void judge() {
    if (judgeChangingOffset()) return;
    if (turning_.correlation < kSame && isTurning()) {
      add(Severity::Warning, 80.0, "camera_unrelated",
          fmt::format("images and gyroscope do not turn together (correlation {:.2f}): recorded at other "
                      "times, clocks "
                      "more than 8 s apart, dead axes of the gyroscope, or images without texture",
                      turning_.correlation));
      return;
    }
    if (isGyroscopeDead()) return;
    if (turning_.correlation < kJudgeable) {
      if (judgeLag()) return;
      add(Severity::Notice, 0.0, "turns_too_vague",
          fmt::format("images and gyroscope agree too loosely (correlation {:.2f}) to judge extrinsics, "
                      "focal length and "
                      "time offset: little turning, or too much else that moves",
                      turning_.correlation));
      return;
    }
    judgeOffset();
    if (judgeAxes()) return;
    judgeFocalLength();
  }

 private:
  void add(Severity severity, double harm, const std::string& kind, const std::string& message) {
    inspection_->findings.push_back({severity, harm, name_, kind, message});
  }

  /// A rig at rest seems to rotate slightly by noise and by other moving objects.
  bool isTurning() const {
    constexpr double kTurning_rad_per_s = 0.05, kPlainlyTurning_rad_per_s = 0.2;
    return turning_.gyroscope_rate_rad_per_s > kTurning_rad_per_s ||
           turning_.camera_rate_rad_per_s > kPlainlyTurning_rad_per_s;
  }

  /// With a dead axis, relations between axes are meaningless; that axis has a finding already, or gets it
  /// here where noise hides it.
  bool isGyroscopeDead() {
    for (const bool dead : inspection_->imu.gyroscope.is_dead) {
      if (dead) return true;
    }
    return false;
  }

  /// A clock that jumped between the two halves of the rotations: a single offset would be wrong for one of
  /// them.
  bool judgeChangingOffset() {
    const std::optional<TurnComparison>& early = camera_.turning_early;
    const std::optional<TurnComparison>& late = camera_.turning_late;
    if (!early || !late || early->correlation < kJudgeable || late->correlation < kJudgeable) return false;
    const double change_s = late->time_offset_s - early->time_offset_s;
    const double sigma_s = std::hypot(early->time_offset_sigma_s, late->time_offset_sigma_s);
    if (std::abs(change_s) < kHarmfulChange_s || std::abs(change_s) < kSignificant_sigmas * sigma_s)
      return false;
    const std::vector<CameraTurn>& turns = camera_.survey.turns;
    add(Severity::Serious, 84.0, "camera_clock_jump",
        fmt::format("a clock jumps: the images' stamps are off the gyroscope's by {:.0f} ms around {} ns and "
                    "by {:.0f} ms "
                    "around {} ns (+-{:.1f}). No single timeshift_cam_imu is right: fix the clock, or cut "
                    "the recording "
                    "where it jumps",
                    -1e3 * early->time_offset_s, turns[turns.size() / 4].begin.nanoseconds(),
                    -1e3 * late->time_offset_s, turns[3 * turns.size() / 4].begin.nanoseconds(),
                    1e3 * sigma_s));
    return true;
  }

  /// Lag behind the first camera where the rotations are too vague for the offset of each to the gyroscope.
  /// Their errors are mostly common to both. Returns true where there is a lag.
  bool judgeLag() {
    const CameraInspection& first = inspection_->cameras.front();
    if (&first == &camera_ || !first.turning || first.turning->correlation < kSame) return false;
    const double lag_s = first.turning->time_offset_s - turning_.time_offset_s;
    const double sigma_s = std::hypot(turning_.time_offset_sigma_s, first.turning->time_offset_sigma_s);
    if (std::abs(lag_s) < kHarmfulChange_s || std::abs(lag_s) < kSignificant_sigmas * sigma_s) return false;
    add(Severity::Serious, 82.5, "cameras_apart",
        fmt::format(
            "time offset: its images are {:.0f} ms (+-{:.1f}) {} those of {} by the rotations of both{}; "
            "pair the images that belong together, or set timeshift_cam_imu to {:.4f} s",
            1e3 * std::abs(lag_s), 1e3 * sigma_s, lag_s > 0.0 ? "behind" : "ahead of", first.survey.name,
            wholeFrames(lag_s), calibration_.time_offset_to_imu_s - lag_s));
    return true;
  }

  /// A lag of whole frames behind the first camera in words; empty for another lag.
  std::string wholeFrames(double lag_s) const {
    constexpr double kSame_frames = 0.15;
    const double frames = lag_s * camera_.survey.stream.rate_hz;
    const double whole = std::round(frames);
    if (whole == 0.0 || std::abs(frames - whole) > kSame_frames) return {};
    return fmt::format(", which is {:.0f} frame{}: each image carries the stamp of {}", std::abs(whole),
                       std::abs(whole) == 1.0 ? "" : "s", whole > 0.0 ? "a later one" : "an earlier one");
  }

  std::string framesBehindFirst() const {
    const CameraInspection& first = inspection_->cameras.front();
    if (&first == &camera_ || !first.turning) return {};
    return wholeFrames(first.turning->time_offset_s - turning_.time_offset_s);
  }

  void judgeOffset() {
    const double offset_s = turning_.time_offset_s;
    const double sigma_s = turning_.time_offset_sigma_s;
    if (std::abs(offset_s) < kHarmfulOffset_s || std::abs(offset_s) < kSignificant_sigmas * sigma_s) return;
    add(Severity::Serious, 83.0, kCameraTimeOffset,
        fmt::format("time offset: the images' stamps {} the gyroscope's by {:.0f} ms (+-{:.1f}){}; set "
                    "timeshift_cam_imu to "
                    "{:.4f} s or fix the clock",
                    offset_s < 0.0 ? "lag behind" : "run ahead of", 1e3 * std::abs(offset_s), 1e3 * sigma_s,
                    framesBehindFirst(), calibration_.time_offset_to_imu_s + offset_s));
  }

  /// Returns true where the axes are so wrong that focal lengths cannot be evaluated.
  bool judgeAxes() {
    if (turning_.is_mirrored) {
      add(Severity::Serious, 91.0, "axes_mirrored",
          fmt::format("axes swapped: images and gyroscope turn as in a mirror; the axes of the IMU are "
                      "exchanged or have a "
                      "wrong sign (as if {}), or the images are mirrored",
                      describeSignedAxes(nearestSignedAxes(turning_.axes))));
      return true;
    }
    if (turning_.misalignment_rad < kHarmfulMisalignment_rad) return false;
    const double angle_deg = kDegreesPerRadian * turning_.misalignment_rad;
    const Vec3 axis_C =
        calibration_.body_from_camera.rotation.conjugate() * turning_.misalignment_B.normalized();
    const Mat3 nearest = nearestSignedAxes(turning_.axes);
    const bool is_whole = !nearest.isIdentity() && Quat(nearest).angularDistance(Quat(turning_.axes)) < 0.3;
    std::string where = fmt::format(
        "extrinsics: the camera's rotation to the IMU is {:.0f} deg off what the calibration (T_BS) says, "
        "about the "
        "camera's ({:.2f}, {:.2f}, {:.2f}) axis",
        angle_deg, axis_C.x(), axis_C.y(), axis_C.z());
    const Quat given = calibration_.body_from_camera.rotation;
    const double off_inverse_rad = given.conjugate().angularDistance(Quat(turning_.axes) * given);
    if (off_inverse_rad < kHarmfulMisalignment_rad) {
      where += "; T_BS inverted would fit (it is to take camera coordinates to those of the body)";
    }
    if (is_whole && angle_deg > 150.0 && std::abs(axis_C.z()) > 0.9) {
      add(Severity::Serious, 88.0, "images_upside_down",
          "the images are upside down for this calibration: they are turned by 180 deg about the optical "
          "axis (or the " +
              where + ")");
    } else if (is_whole) {
      add(Severity::Serious, 88.0, "extrinsics_rotation",
          fmt::format("{}: wrong T_BS, turned images, or the axes of the IMU swapped (as if {})", where,
                      describeSignedAxes(nearest)));
    } else {
      add(Severity::Serious, 82.0, "extrinsics_rotation", where + "; calibrate camera and IMU together");
    }
    return angle_deg > 30.0;
  }

  void judgeFocalLength() {
    const double error = turning_.focal_ratio - 1.0;
    if (std::abs(error) < kHarmfulFocalError ||
        std::abs(error) < kSignificant_sigmas * turning_.focal_ratio_sigma)
      return;
    add(Severity::Serious, 81.0, "intrinsics_focal",
        fmt::format("intrinsics: the focal length is wrong by about {:.0f} %: pan and tilt look {:.2f} times "
                    "as large as the "
                    "gyroscope says; {:.0f} px would fit, not {:.0f} px",
                    100.0 * std::abs(error), turning_.focal_ratio, calibration_.fx_px * turning_.focal_ratio,
                    calibration_.fx_px));
  }

  std::string name_;
  const CameraInspection& camera_;
  const CameraCalibration& calibration_;
  const TurnComparison& turning_;
  Inspection* inspection_;
};

}  // namespace

void judgeTurning(Inspection* inspection) {
  for (size_t i = 0; i < inspection->cameras.size(); ++i) {
    if (!inspection->cameras[i].turning) continue;
    TurningJudge(inspection->cameras[i], inspection->rig.cameras[i], inspection).judge();
  }
}

}  // namespace lodeline::findings
