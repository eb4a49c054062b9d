#include "lodeline/geometry/so3.h"
#include "lodeline/rig_calibration/report/rig_report.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

using Json = nlohmann::ordered_json;

Json listOf(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Json poseJson(const Rigid3& pose, const std::optional<PoseSigmas>& sigmas) {
  Json json;
  json["rotation_rad"] = listOf(so3::log(pose.rotation));
  json["translation_m"] = listOf(pose.translation);
  if (sigmas) {
    json["rotation_sigma_rad"] = listOf(sigmas->rotation_rad);
    json["translation_sigma_m"] = listOf(sigmas->translation_m);
  }
  return json;
}

Json portJson(const Port& port, const std::optional<Vec3>& sigmas) {
  Json json;
  if (port.type == Port::Type::Flat) {
    json["type"] = "flat";
    json["normal"] = listOf(port.normal_C);
    json["distance_m"] = port.distance_m;
    if (sigmas) {
      json["tilt_sigma_rad"] = {sigmas->x(), sigmas->y()};
      json["distance_sigma_m"] = sigmas->z();
    }
    return json;
  }
  json["type"] = "dome";
  json["centre_m"] = listOf(port.centre_C);
  if (sigmas) json["centre_sigma_m"] = listOf(*sigmas);
  return json;
}

Json cameraJson(const CameraCalibrationResult& camera, bool has_imu) {
  const CameraCalibration& c = camera.calibration;
  Json json;
  json["name"] = c.name;
  json["model"] = c.model;
  json["resolution_px"] = {c.width_px, c.height_px};
  std::vector<double> lens = {c.fx_px, c.fy_px, c.cx_px, c.cy_px};
  lens.insert(lens.end(), c.distortion.begin(), c.distortion.end());
  json["lens"] = lens;
  json["lens_sigma"] = camera.lens_sigmas;
  if (c.port) json["port"] = portJson(*c.port, camera.port_sigmas);
  if (c.port) json["port"]["index_water"] = c.port->index_water;
  if (camera.index_sigma) json["port"]["index_water_sigma"] = *camera.index_sigma;
  json["first_from_camera"] = poseJson(camera.first_from_camera, camera.first_sigmas);
  if (has_imu) {
    json["imu_from_camera"] = poseJson(c.body_from_camera, camera.body_sigmas);
    json["delay_s"] = c.time_offset_to_imu_s;
    if (camera.delay_sigma_s) json["delay_sigma_s"] = *camera.delay_sigma_s;
  }
  json["images"] = camera.images;
  json["views"] = camera.views;
  json["corners"] = camera.corners.size();
  json["residual_rms_px"] = camera.rms_px;
  json["corner_sigma_px"] = camera.sigma_px;
  json["outlier_percent"] = 100.0 * camera.outlier_share;
  json["coverage_percent"] = 100.0 * camera.coverage_share;
  json["tilt_deg"] = camera.largest_tilt_rad / kDegree;
  return json;
}

}  // namespace

nlohmann::ordered_json rigCalibrationJson(const RigCalibrationResult& result) {
  Json json;
  json["verdict"] = toString(result.verdict);
  json["reasons"] = Json::array();
  for (const CalibrationDoubt& doubt : result.doubts)
    json["reasons"].push_back({{"verdict", toString(doubt.verdict)}, {"text", doubt.text}});
  json["board"] = {{"columns", result.board.columns},
                   {"rows", result.board.rows},
                   {"tag_size_m", result.board.tag_size_m},
                   {"spacing", result.board.spacing}};
  json["sigma_inflation"] = result.sigma_inflation;
  for (const CameraCalibrationResult& camera : result.cameras)
    json["cameras"].push_back(cameraJson(camera, result.inertial.has_value()));
  if (!result.inertial) {
    json["without_imu"] = result.without_inertial;
    return json;
  }
  const InertialResult& imu = *result.inertial;
  json["imu"] = {{"gyroscope_bias_rad_per_s", listOf(imu.gyroscope_bias_B)},
                 {"accelerometer_bias_m_per_s2", listOf(imu.accelerometer_bias_B)},
                 {"error_over_noise", imu.inertial_error},
                 {"rate_error_rad_per_s", imu.rate_error_rad_per_s},
                 {"least_rate_rad_per_s", imu.least_rate_rad_per_s},
                 {"least_acceleration_m_per_s2", imu.least_acceleration_m_per_s2}};
  return json;
}

}  // namespace lodeline
