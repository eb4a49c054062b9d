#include <fmt/core.h>

#include <algorithm>

#include "lodeline/rig_calibration/result/rig_calibration.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

/// Limits of a figure: beyond the first one a result is usable, beyond the second one poor.
struct Limits {
  double usable, poor;
};

// Sigmas beyond which a run of `lodeline run` visibly suffers; docs/theory/camera-calibration.md.
constexpr Limits kFocalSigma = {1e-3, 4e-3};    // relative
constexpr Limits kCentreSigma_px = {0.5, 2.0};  // for images of 640 px
constexpr Limits kRms_px = {0.5, 1.5};          // for images of 640 px
constexpr Limits kOutliers = {0.05, 0.25};
constexpr Limits kTurnSigma_deg = {0.1, 0.5};
constexpr Limits kShiftSigma_mm = {2.0, 10.0};
constexpr Limits kDelaySigma_ms = {0.3, 2.0};
constexpr Limits kPortTiltSigma_deg = {0.3, 1.5};
constexpr Limits kPortLengthSigma_mm = {1.5, 6.0};
constexpr Limits kInertialError = {4.0, 15.0};
// Least values.
constexpr Limits kViews = {25, 8};
constexpr Limits kCoverage = {0.6, 0.3};
constexpr Limits kTilt_deg = {15.0, 6.0};
constexpr Limits kRate_rad_per_s = {0.15, 0.03};
constexpr Limits kAcceleration_m_per_s2 = {0.15, 0.03};

class Judge {
 public:
  explicit Judge(std::vector<CalibrationDoubt>* doubts) : doubts_(doubts) {}

  template <typename... Values>
  void most(double value, const Limits& limits, fmt::format_string<Values...> text, Values&&... values) {
    if (value <= limits.usable) return;
    add(value > limits.poor, fmt::format(text, std::forward<Values>(values)...));
  }
  template <typename... Values>
  void least(double value, const Limits& limits, fmt::format_string<Values...> text, Values&&... values) {
    if (value >= limits.usable) return;
    add(value < limits.poor, fmt::format(text, std::forward<Values>(values)...));
  }

 private:
  void add(bool is_poor, const std::string& text) {
    doubts_->push_back({is_poor ? CalibrationVerdict::Poor : CalibrationVerdict::Usable, text});
  }
  std::vector<CalibrationDoubt>* doubts_;
};

void judgeViews(const CameraCalibrationResult& camera, Judge* judge) {
  const std::string& name = camera.calibration.name;
  judge->least(static_cast<double>(camera.views), kViews, "{}: too few views of the board ({})", name,
               camera.views);
  judge->least(camera.coverage_share, kCoverage,
               "{}: poor coverage, {:.0f} % of the image; bring the board to all borders and corners", name,
               100.0 * camera.coverage_share);
  judge->least(camera.largest_tilt_rad / kDegree, kTilt_deg,
               "{}: the board was hardly tilted against the image, {:.0f} degrees; look at it from all sides",
               name, camera.largest_tilt_rad / kDegree);
}

void judgeLens(const CameraCalibrationResult& camera, Judge* judge) {
  const CameraCalibration& c = camera.calibration;
  const double scale = c.width_px / 640.0;
  judge->most(
      camera.rms_px / scale, kRms_px,
      "{}: the residual is large, {:.2f} px; another camera model, a port, a bent board, motion blur or "
      "a wrong size of the tags may be the reason",
      c.name, camera.rms_px);
  judge->most(camera.outlier_share, kOutliers, "{}: {:.0f} % of the corners do not fit", c.name,
              100.0 * camera.outlier_share);
  if (camera.lens_sigmas.empty()) return;
  const double focal = std::max(camera.lens_sigmas[0] / c.fx_px, camera.lens_sigmas[1] / c.fy_px);
  judge->most(focal, kFocalSigma, "{}: the focal length is known to {:.2f} % only", c.name, 100.0 * focal);
  const double centre_px = std::max(camera.lens_sigmas[2], camera.lens_sigmas[3]);
  judge->most(centre_px / scale, kCentreSigma_px, "{}: the principal point is known to {:.1f} px only",
              c.name, centre_px);
}

void judgePort(const CameraCalibrationResult& camera, Judge* judge) {
  if (!camera.port_sigmas) return;
  const std::string& name = camera.calibration.name;
  const Vec3& sigmas = *camera.port_sigmas;
  if (camera.calibration.port->type == Port::Type::Flat) {
    const double tilt_deg = sigmas.head<2>().maxCoeff() / kDegree;
    judge->most(tilt_deg, kPortTiltSigma_deg, "{}: the normal of the port is known to {:.1f} degrees only",
                name, tilt_deg);
    judge->most(1e3 * sigmas[2], kPortLengthSigma_mm,
                "{}: the distance of the port is hardly observable, {:.1f} mm; keep a lens from air "
                "(--keep lens) and bring the board closer",
                name, 1e3 * sigmas[2]);
  } else {
    judge->most(
        1e3 * sigmas.maxCoeff(), kPortLengthSigma_mm,
        "{}: the centre of the dome is hardly observable, {:.1f} mm; keep a lens from air (--keep lens) "
        "and bring the board closer",
        name, 1e3 * sigmas.maxCoeff());
  }
}

void judgePoses(const CameraCalibrationResult& camera, Judge* judge) {
  const auto one = [&](const std::optional<PoseSigmas>& sigmas, const char* to) {
    if (!sigmas) return;
    const double turn_deg = sigmas->rotation_rad.maxCoeff() / kDegree;
    const double shift_mm = 1e3 * sigmas->translation_m.maxCoeff();
    judge->most(turn_deg, kTurnSigma_deg, "{}: its rotation to {} is known to {:.2f} degrees only",
                camera.calibration.name, to, turn_deg);
    judge->most(shift_mm, kShiftSigma_mm, "{}: its position on {} is known to {:.1f} mm only",
                camera.calibration.name, to, shift_mm);
  };
  one(camera.first_sigmas, "the first camera");
  one(camera.body_sigmas, "the IMU");
  if (camera.delay_sigma_s) {
    judge->most(1e3 * *camera.delay_sigma_s, kDelaySigma_ms,
                "{}: the delay to the IMU is hardly observable, {:.2f} ms; turn the rig faster",
                camera.calibration.name, 1e3 * *camera.delay_sigma_s);
  }
}

}  // namespace

const char* toString(CalibrationVerdict verdict) {
  switch (verdict) {
    case CalibrationVerdict::Good:
      return "good";
    case CalibrationVerdict::Usable:
      return "usable";
    case CalibrationVerdict::Poor:
      break;
  }
  return "poor";
}

void judge(RigCalibrationResult* result) {
  result->doubts.clear();
  Judge judge(&result->doubts);
  for (const CameraCalibrationResult& camera : result->cameras) {
    judgeViews(camera, &judge);
    judgeLens(camera, &judge);
    judgePort(camera, &judge);
    judgePoses(camera, &judge);
  }
  if (result->inertial) {
    const InertialResult& inertial = *result->inertial;
    judge.least(inertial.least_rate_rad_per_s, kRate_rad_per_s,
                "little rotation about one axis, {:.2f} rad/s; turn the rig about all three axes",
                inertial.least_rate_rad_per_s);
    judge.least(inertial.least_acceleration_m_per_s2, kAcceleration_m_per_s2,
                "little acceleration along one axis, {:.2f} m/s^2; shake the rig along all three axes",
                inertial.least_acceleration_m_per_s2);
    judge.most(inertial.inertial_error, kInertialError,
               "the inertial readings scatter {:.0f} times as much as their noise densities say; vibration, "
               "scale errors, or a delay that varies may be the reason",
               inertial.inertial_error);
  }
  std::stable_sort(
      result->doubts.begin(), result->doubts.end(),
      [](const CalibrationDoubt& a, const CalibrationDoubt& b) { return a.verdict > b.verdict; });
  result->verdict = result->doubts.empty() ? CalibrationVerdict::Good : result->doubts.front().verdict;
}

}  // namespace lodeline
