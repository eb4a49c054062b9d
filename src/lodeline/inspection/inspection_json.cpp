#include <cmath>

#include "lodeline/inspection/inspection_report.h"
#include "lodeline/inspection/survey/camera_words.h"

namespace lodeline {
namespace {

using Json = nlohmann::ordered_json;

Json vector(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Json streamJson(const Inspection& inspection, const std::string& sensor, const StreamSummary& stream) {
  Json gaps = Json::array();
  constexpr size_t kMostGaps = 100;
  for (size_t i = 0; i < std::min(kMostGaps, stream.gaps.size()); ++i) {
    gaps.push_back({{"after_ns", stream.gaps[i].after.nanoseconds()}, {"length_s", stream.gaps[i].length_s}});
  }
  return {{"sensor", sensor},
          {"verdict", inspection.verdict(sensor)},
          {"readings", stream.readings},
          {"rate_hz", stream.rate_hz},
          {"duration_s", stream.duration_s},
          {"jitter_s", stream.jitter_s},
          {"duplicates", stream.duplicates},
          {"backwards", stream.backwards},
          {"repeated", stream.repeated},
          {"longest_frozen_s", stream.longest_frozen_s},
          {"gap_s", stream.gap_s},
          {"gaps", gaps}};
}

Json imuJson(const Inspection& inspection) {
  const ImuSurvey& imu = inspection.imu;
  Json json = streamJson(inspection, "imu0", imu.stream);
  json["median_force"] = imu.median_force;
  json["force_to_m_per_s2"] = imu.force_to_SI;
  json["rate_to_rad_per_s"] = inspection.rate_to_SI;
  json["gyroscope_spread"] = vector(imu.gyroscope.spread);
  json["gyroscope_saturated_share"] = imu.gyroscope.saturated_share;
  json["accelerometer_saturated_share"] = imu.accelerometer.saturated_share;
  json["accelerometer_vibration_m_per_s2"] = inspection.force_vibration.strong;
  json["gyroscope_vibration_rad_per_s"] = inspection.rate_vibration.strong;
  json["rest_s"] = imu.rest_s;
  if (imu.rest_s > 0.0) {
    json["gravity_at_rest_m_per_s2"] = imu.rest_force_m_per_s2;
    json["gyroscope_at_rest_rad_per_s"] = vector(inspection.rate_to_SI * imu.rest_rate_B);
  }
  return json;
}

Json framesJson(const CameraSurvey& survey) {
  Json frames = Json::array();
  for (const FrameSurvey& frame : survey.frames) {
    frames.push_back({{"stamp_ns", frame.time.nanoseconds()},
                      {"word", frame.quality.word},
                      {"mean_grey", frame.quality.mean_grey},
                      {"contrast_grey", frame.quality.contrast_grey},
                      {"sharpness", frame.quality.sharpness},
                      {"saturated", frame.quality.saturated},
                      {"corners", frame.corners},
                      {"followed", frame.followed}});
  }
  return frames;
}

Json cameraJson(const Inspection& inspection, size_t index) {
  const CameraInspection& camera = inspection.cameras[index];
  Json json = streamJson(inspection, camera.survey.name, camera.survey.stream);
  if (isCalibrated(inspection.rig.cameras[index])) {
    json["axes"] = describeAxes(inspection.rig.cameras[index]);
    if (!inspection.imu.samples.empty()) {
      json["gravity"] = describeGravity(inspection.rig.cameras[index], inspection.imu.up_B);
    }
  }
  json["unreadable"] = camera.survey.unreadable;
  json["identical"] = camera.survey.identical;
  if (camera.turning) {
    const TurnComparison& turning = *camera.turning;
    json["turning"] = {{"images", turning.turns},
                       {"correlation", turning.correlation},
                       {"time_offset_s", turning.time_offset_s},
                       {"time_offset_sigma_s", turning.time_offset_sigma_s},
                       {"misalignment_rad", turning.misalignment_rad},
                       {"misalignment_B", vector(turning.misalignment_B)},
                       {"hidden_axes", turning.hidden_axes},
                       {"is_mirrored", turning.is_mirrored},
                       {"gyroscope_scale", turning.gyroscope_scale},
                       {"focal_ratio", turning.focal_ratio},
                       {"explained", turning.explained}};
  }
  if (index == 1 && inspection.stereo) {
    json["stereo"] = {{"baseline_m", inspection.stereo->baseline_m},
                      {"images", inspection.stereo->images},
                      {"points", inspection.stereo->points},
                      {"agreement", inspection.stereo->agreement}};
  }
  json["frames"] = framesJson(camera.survey);
  return json;
}

Json magnetometerJson(const Inspection& inspection) {
  const MagnetometerSurvey& survey = *inspection.magnetometer;
  Json json = streamJson(inspection, "mag0", survey.stream);
  json["unit"] = toString(survey.unit);
  json["field_T"] = survey.field_T;
  json["field_spread"] = survey.field_spread;
  if (survey.inclination_rad) json["inclination_rad"] = *survey.inclination_rad;
  if (survey.turning) {
    json["scatter"] = survey.turning->scatter;
    json["time_offset_s"] = survey.turning->time_offset_s;
  }
  return json;
}

}  // namespace

nlohmann::ordered_json inspectionJson(const Inspection& inspection) {
  Json json;
  json["findings"] = Json::array();
  for (const InspectionFinding& finding : inspection.findings) {
    json["findings"].push_back({{"severity", toString(finding.severity)},
                                {"sensor", finding.sensor},
                                {"kind", finding.kind},
                                {"message", finding.message}});
  }
  json["sensors"] = Json::array();
  if (!inspection.imu.samples.empty()) json["sensors"].push_back(imuJson(inspection));
  for (size_t i = 0; i < inspection.cameras.size(); ++i) json["sensors"].push_back(cameraJson(inspection, i));
  if (inspection.magnetometer) json["sensors"].push_back(magnetometerJson(inspection));
  for (const PlainSurvey& other : inspection.others) {
    Json entry = streamJson(inspection, other.sensor, other.stream);
    entry["values"] = Json::array();
    for (const ValueRange& value : other.values) {
      entry["values"].push_back(
          {{"name", value.name}, {"unit", value.unit}, {"least", value.least}, {"greatest", value.greatest}});
    }
    if (other.lock) {
      entry["pings_without_lock"] = other.lock->without_lock;
      entry["pings_without_some_beams"] = other.lock->partial;
    }
    if (other.sensor == "dvl0" && inspection.dvl) {
      entry["imu_motion_m_per_s"] = inspection.dvl->motion_m_per_s;
      entry["imu_remainder_m_per_s"] = inspection.dvl->remainder_m_per_s;
      entry["imu_time_offset_s"] = inspection.dvl->time_offset_s;
    }
    if (other.sensor == "dvl0" && inspection.dvl_images) {
      entry["image_pairs"] = inspection.dvl_images->pairs;
      entry["image_angle_rad"] = inspection.dvl_images->angle_rad;
      entry["image_time_offset_s"] = inspection.dvl_images->time_offset_s;
    }
    if (other.sensor == "current0" && inspection.currents) {
      entry["field_scatter_T"] = inspection.currents->scatter_T;
      entry["field_scatter_with_currents_T"] = inspection.currents->explained_scatter_T;
      entry["field_time_offset_s"] = inspection.currents->time_offset_s;
    }
    json["sensors"].push_back(entry);
  }
  return json;
}

}  // namespace lodeline
