#include "simulation/recording/recording_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "lodeline/cameras/camera_file_keys.h"
#include "lodeline/io/calibration/camera_keys.h"

namespace lodeline {
namespace {

std::string transform(const Rigid3& body_from_sensor) {
  const Eigen::Matrix4d m = body_from_sensor.matrix();
  std::string text = "T_BS:\n  cols: 4\n  rows: 4\n  data: [";
  for (int row = 0; row < 4; ++row) {
    text += fmt::format("{}{}, {}, {}, {}", row == 0 ? "" : ",\n         ", m(row, 0), m(row, 1), m(row, 2),
                        m(row, 3));
  }
  return text + "]\n";
}

std::string cameraText(const CameraCalibration& c) {
  const CameraFileKeys keys = cameraFileKeys(c);
  std::string text = "sensor_type: camera\n" + transform(c.body_from_camera);
  text += fmt::format("rate_hz: {}\nresolution: [{}, {}]\ncamera_model: {}\n", c.rate_hz, c.width_px,
                      c.height_px, keys.camera_model);
  text += fmt::format("intrinsics: [{}]  # {}\n", fmt::join(keys.intrinsics, ", "),
                      intrinsicsNames(cameraModel(c)));
  text += fmt::format("distortion_model: {}\ndistortion_coefficients: [{}]\n", keys.distortion_model,
                      fmt::join(keys.distortion_coefficients, ", "));
  if (c.port) text += fmt::format("port: {}\n", portText(*c.port));
  if (c.time_offset_to_imu_s != 0.0) text += fmt::format("timeshift_cam_imu: {}\n", c.time_offset_to_imu_s);
  return text + shutterText(c, "");
}

std::string imuText(const ImuCalibration& imu) {
  const ImuNoise& n = imu.noise;
  return "sensor_type: imu\n" + transform(Rigid3()) +
         fmt::format(
             "rate_hz: {}\n"
             "gyroscope_noise_density: {}  # rad/s/sqrt(Hz)\n"
             "gyroscope_random_walk: {}  # rad/s^2/sqrt(Hz)\n"
             "accelerometer_noise_density: {}  # m/s^2/sqrt(Hz)\n"
             "accelerometer_random_walk: {}  # m/s^3/sqrt(Hz)\n",
             imu.rate_hz, n.gyroscope_density_rad_per_s_sqrtHz, n.gyroscope_random_walk_rad_per_s2_sqrtHz,
             n.accelerometer_density_m_per_s2_sqrtHz, n.accelerometer_random_walk_m_per_s3_sqrtHz);
}

std::string sonarText(const char* type, const SonarCalibration& sonar) {
  std::string text = fmt::format("sensor_type: {}\n", type) + transform(sonar.body_from_sonar) +
                     fmt::format("rate_hz: {}\nrange_noise_std: {}  # m\nbeam_width: {}  # rad\n",
                                 sonar.rate_hz, sonar.range_noise_std_m, sonar.beam_width_rad);
  if (sonar.max_range_m > 0.0) text += fmt::format("max_range: {}  # m\n", sonar.max_range_m);
  return text;
}

std::string dvlText(const DvlCalibration& dvl) {
  std::string text = "sensor_type: dvl\n" + transform(dvl.body_from_dvl) +
                     fmt::format(
                         "rate_hz: {}\nvelocity_noise_std: {}  # m/s\nrange_noise_std: {}  # m\n"
                         "scale_sigma: {}  # relative\nmisalignment_sigma: {}  # rad\nbeams:\n",
                         dvl.rate_hz, dvl.velocity_noise_std_m_per_s, dvl.range_noise_std_m, dvl.scale_sigma,
                         dvl.misalignment_sigma_rad);
  for (const Vec3& beam : dvl.beams_D)
    text += fmt::format("  - [{}, {}, {}]\n", beam.x(), beam.y(), beam.z());
  return text;
}

std::string currentText(const CurrentCalibration& currents) {
  std::string text = fmt::format("sensor_type: current\nrate_hz: {}\n", currents.rate_hz);
  if (currents.fields_T_per_A.empty())
    return text + fmt::format("channels: [{}]\n", fmt::join(currents.channels, ", "));
  text += "channels:\n";
  for (size_t i = 0; i < currents.channels.size(); ++i) {
    const Vec3& k = currents.fields_T_per_A[i];
    text += fmt::format("  {}: {{field_T_per_A: [{}, {}, {}]}}\n", currents.channels[i], k.x(), k.y(), k.z());
  }
  return text;
}

void writeText(const std::filesystem::path& path, const std::string& text) {
  RecordingFile file(path);
  file.write(text);
  file.close();
}

}  // namespace

void writeCalibration(const Rig& rig, const std::filesystem::path& mav0) {
  for (const CameraCalibration& camera : rig.cameras)
    writeText(mav0 / camera.name / "sensor.yaml", cameraText(camera));
  writeText(mav0 / "imu0" / "sensor.yaml", imuText(rig.imu));
  if (rig.magnetometer) {
    writeText(mav0 / "mag0" / "sensor.yaml",
              "sensor_type: magnetometer\n" + transform(rig.magnetometer->body_from_magnetometer) +
                  fmt::format("rate_hz: {}\nmagnetometer_noise_density: {}  # T/sqrt(Hz)\n",
                              rig.magnetometer->rate_hz, rig.magnetometer->noise_density_T_per_sqrtHz));
  }
  if (rig.pressure) {
    writeText(mav0 / "pressure0" / "sensor.yaml",
              "sensor_type: pressure\n" + transform(rig.pressure->body_from_pressure) +
                  fmt::format("rate_hz: {}\ndepth_noise_std: {}  # m\n", rig.pressure->rate_hz,
                              rig.pressure->depth_noise_std_m));
  }
  if (rig.sonar) writeText(mav0 / "sonar0" / "sensor.yaml", sonarText("sonar", *rig.sonar));
  if (rig.altimeter) writeText(mav0 / "altimeter0" / "sensor.yaml", sonarText("altimeter", *rig.altimeter));
  if (rig.dvl) writeText(mav0 / "dvl0" / "sensor.yaml", dvlText(*rig.dvl));
  if (rig.currents) writeText(mav0 / "current0" / "sensor.yaml", currentText(*rig.currents));
}

std::string numbers(const Vec3& v) { return fmt::format("[{}, {}, {}]", v.x(), v.y(), v.z()); }

std::string numbers(const Mat3& m) {
  const Vec3 a = m.row(0), b = m.row(1), c = m.row(2);
  return fmt::format("[{}, {}, {}]", numbers(a), numbers(b), numbers(c));
}

}  // namespace lodeline
