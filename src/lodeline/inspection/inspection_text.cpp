#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lodeline/inspection/inspection_report.h"
#include "lodeline/inspection/survey/camera_words.h"
#include "lodeline/util/angles.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

std::string findingsLines(const Inspection& inspection) {
  std::string text;
  int number = 0;
  for (const InspectionFinding& finding : inspection.findings) {
    if (finding.severity == Severity::Notice) continue;
    text +=
        fmt::format("{}. {} {}: {}\n", ++number, toString(finding.severity), finding.sensor, finding.message);
  }
  if (number == 0) text = "nothing found that would hurt\n";
  for (const InspectionFinding& finding : inspection.findings) {
    if (finding.severity == Severity::Notice)
      text += fmt::format("   {}: {}\n", finding.sensor, finding.message);
  }
  return text;
}

std::string streamLine(const Inspection& inspection, const std::string& sensor, const StreamSummary& stream) {
  std::string text =
      fmt::format("{:<10}{:<9}{:>9} readings  {:>8.2f} Hz  {:>8.1f} s", sensor, inspection.verdict(sensor),
                  stream.readings, stream.rate_hz, stream.duration_s);
  text += fmt::format("  gaps {}  duplicates {}  disorder {}", stream.gaps.size(), stream.duplicates,
                      stream.backwards);
  if (stream.repeated > 0) {
    text += fmt::format("  repeated {:.1f} %",
                        100.0 * static_cast<double>(stream.repeated) / static_cast<double>(stream.readings));
  }
  return text + "\n";
}

std::string imuText(const Inspection& inspection) {
  const ImuSurvey& imu = inspection.imu;
  if (imu.samples.empty()) return {};
  std::string text = streamLine(inspection, "imu0", imu.stream);
  text += fmt::format("          specific force {:.3f} m/s^2 (median)", imu.median_force * imu.force_to_SI);
  if (imu.rest_s > 0.0) {
    const Vec3 bias_deg = kDegreesPerRadian * inspection.rate_to_SI * imu.rest_rate_B;
    text +=
        fmt::format("; at rest for {:.1f} s: gravity {:.3f} m/s^2, gyroscope bias {:.2f} {:.2f} {:.2f} deg/s",
                    imu.rest_s, imu.rest_force_m_per_s2, bias_deg.x(), bias_deg.y(), bias_deg.z());
  } else {
    text += "; never at rest, so that biases cannot be read off";
  }
  const Vec3 spread_deg = kDegreesPerRadian * inspection.rate_to_SI * imu.gyroscope.spread;
  text += fmt::format("\n          turns by {:.1f} {:.1f} {:.1f} deg/s (standard deviation about x y z)\n",
                      spread_deg.x(), spread_deg.y(), spread_deg.z());
  for (const InspectionFinding& finding : inspection.findings) {
    if (finding.kind == "imu_vibration") text += fmt::format("          {}\n", finding.message);
  }
  return text;
}

std::string qualityText(const CameraSurvey& survey) {
  if (survey.frames.empty()) return {};
  std::vector<double> grey, contrast, sharpness, saturated, corners, followed;
  for (const FrameSurvey& frame : survey.frames) {
    grey.push_back(frame.quality.mean_grey);
    contrast.push_back(frame.quality.contrast_grey);
    sharpness.push_back(frame.quality.sharpness);
    saturated.push_back(frame.quality.saturated);
    corners.push_back(frame.corners);
    if (frame.followed >= 0) followed.push_back(frame.followed);
  }
  return fmt::format(
      "          images (median of {}): grey {:.0f}, contrast {:.0f}, sharpness {:.2f}, saturated {:.1f} %, "
      "{:.0f} points worth "
      "following, {:.0f} followed to the next\n",
      survey.frames.size(), median(grey), median(contrast), median(sharpness), 100.0 * median(saturated),
      median(corners), median(followed));
}

std::string turningText(const CameraInspection& camera) {
  if (!camera.turning)
    return "          turned too little, or was followed too badly, to be compared with the gyroscope\n";
  const TurnComparison& turning = *camera.turning;
  return fmt::format(
      "          with the gyroscope over {} images: correlation {:.3f}, stamps {:+.1f} ms (+-{:.1f}), "
      "rotation {:.1f} deg off{}, focal "
      "length {:.3f} of the calibrated\n",
      turning.turns, turning.correlation, 1e3 * turning.time_offset_s, 1e3 * turning.time_offset_sigma_s,
      kDegreesPerRadian * turning.misalignment_rad,
      turning.hidden_axes > 0 ? fmt::format(" ({} axes not shown by the motion)", turning.hidden_axes) : "",
      turning.focal_ratio);
}

std::string stereoText(const StereoSurvey& stereo) {
  std::string text = fmt::format("          {:.4g} m from cam0", stereo.baseline_m);
  if (stereo.points > 0) {
    text += fmt::format("; of {} points in {} pairs of images, {:.0f} % lie where the calibration says",
                        stereo.points, stereo.images, 100.0 * stereo.agreement);
  }
  return text + "\n";
}

std::string cameraText(const Inspection& inspection, size_t index) {
  const CameraInspection& camera = inspection.cameras[index];
  const CameraCalibration& calibration = inspection.rig.cameras[index];
  std::string text = streamLine(inspection, camera.survey.name, camera.survey.stream);
  if (!isCalibrated(calibration)) return text + qualityText(camera.survey);
  text += fmt::format("          {}\n", describeAxes(calibration));
  if (!inspection.imu.samples.empty()) {
    text += fmt::format("          {}\n", describeGravity(calibration, inspection.imu.up_B));
  }
  text += qualityText(camera.survey);
  if (!inspection.imu.samples.empty()) text += turningText(camera);
  if (index == 1 && inspection.stereo) text += stereoText(*inspection.stereo);
  return text;
}

std::string magnetometerText(const Inspection& inspection) {
  const MagnetometerSurvey& survey = *inspection.magnetometer;
  std::string text = streamLine(inspection, "mag0", survey.stream);
  text += fmt::format("          field {:.2f} uT (spread {:.1f} %)", 1e6 * survey.field_T,
                      100.0 * survey.field_spread);
  if (survey.inclination_rad) {
    text += fmt::format(", {:.1f} deg below the horizon", kDegreesPerRadian * *survey.inclination_rad);
  }
  if (survey.turning) {
    text +=
        fmt::format("; turned back by the gyroscope it scatters by {:.1f} %, least with stamps {:+.0f} ms",
                    100.0 * survey.turning->scatter, 1e3 * survey.turning->time_offset_s);
  }
  return text + "\n";
}

std::string lockText(const DvlLock& lock) {
  if (lock.pings == 0) return {};
  return fmt::format("          no lock in {:.1f} % of the pings, some beams missing in {:.1f} %\n",
                     100.0 * lock.without_lock / lock.pings, 100.0 * lock.partial / lock.pings);
}

std::string dvlText(const DvlComparison& dvl) {
  return fmt::format(
      "          with the IMU over {} pings: velocity changes by {:.3f} m/s, {:.3f} m/s do not fit, least "
      "with stamps "
      "{:+.2f} s\n",
      dvl.pings, dvl.motion_m_per_s, dvl.remainder_m_per_s, dvl.time_offset_s);
}

std::string dvlImagesText(const DvlImageComparison& dvl) {
  return fmt::format(
      "          with the images over {} pairs: directions {:.0f} deg apart, least with stamps {:+.2f} s\n",
      dvl.pairs, kDegreesPerRadian * dvl.angle_rad, dvl.time_offset_s);
}

std::string currentsText(const CurrentComparison& currents) {
  std::string text = fmt::format(
      "          with the magnetometer over {} readings: scatter {:.2f} uT, {:.2f} uT with currents, least "
      "with stamps "
      "{:+.2f} s\n",
      currents.readings, 1e6 * currents.scatter_T, 1e6 * currents.explained_scatter_T,
      currents.time_offset_s);
  for (const ChannelField& channel : currents.channels) {
    const Vec3 field_uT = 1e6 * channel.field_T_per_A;
    text += fmt::format("          {} {:.3f} {:.3f} {:.3f} (+-{:.3f}) uT/A\n", channel.name, field_uT.x(),
                        field_uT.y(), field_uT.z(), 1e6 * channel.sigma_T_per_A);
  }
  return text;
}

}  // namespace

std::string inspectionText(const Inspection& inspection) {
  std::string text = findingsLines(inspection) + "\n" + imuText(inspection);
  for (size_t i = 0; i < inspection.cameras.size(); ++i) text += cameraText(inspection, i);
  if (inspection.magnetometer) text += magnetometerText(inspection);
  for (const PlainSurvey& other : inspection.others) {
    text += streamLine(inspection, other.sensor, other.stream);
    for (const ValueRange& value : other.values) {
      text += fmt::format("          {} {:.2f} to {:.2f} {}\n", value.name, value.least, value.greatest,
                          value.unit);
    }
    if (other.lock) text += lockText(*other.lock);
    if (other.sensor == "dvl0" && inspection.dvl) text += dvlText(*inspection.dvl);
    if (other.sensor == "dvl0" && inspection.dvl_images) text += dvlImagesText(*inspection.dvl_images);
    if (other.sensor == "current0" && inspection.currents) text += currentsText(*inspection.currents);
  }
  return text;
}

}  // namespace lodeline
