#include "lodeline/io/calibration/rig_text.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <Eigen/LU>
#include <filesystem>

#include "lodeline/cameras/camera_file_keys.h"
#include "lodeline/io/calibration/camera_keys.h"

namespace lodeline {
namespace {

std::string transformText(const Rigid3& transform) {
  const Eigen::Matrix4d m = transform.matrix();
  std::string text = "  T_BS:\n";
  for (int row = 0; row < 4; ++row) {
    text += fmt::format("    - [{}, {}, {}, {}]\n", m(row, 0), m(row, 1), m(row, 2), m(row, 3));
  }
  return text;
}

std::string matrixText(const char* key, const Mat3& m) {
  std::string text = fmt::format("    {}:\n", key);
  for (int row = 0; row < 3; ++row)
    text += fmt::format("      - [{}, {}, {}]\n", m(row, 0), m(row, 1), m(row, 2));
  return text;
}

std::string biasText(const Vec3& bias) {
  return bias.isZero(0.0) ? "" : fmt::format("    bias: [{}, {}, {}]\n", bias.x(), bias.y(), bias.z());
}

std::string rateText(double rate_hz) { return rate_hz > 0.0 ? fmt::format("  rate_hz: {}\n", rate_hz) : ""; }

std::string cameraText(const CameraCalibration& camera, bool has_extrinsics) {
  std::string text = has_extrinsics
                         ? transformText(camera.body_from_camera)
                         : "  # T_BS:  camera to IMU coordinates, 4x4; FILL IN, no file given says it\n";
  text += fmt::format("  resolution: [{}, {}]\n", camera.width_px, camera.height_px);
  const CameraFileKeys keys = cameraFileKeys(camera);
  if (keys.camera_model != "pinhole") text += fmt::format("  camera_model: {}\n", keys.camera_model);
  text += fmt::format("  intrinsics: [{}]\n", fmt::join(keys.intrinsics, ", "));
  text += fmt::format("  distortion_model: {}\n", keys.distortion_model);
  if (!keys.distortion_coefficients.empty()) {
    text += fmt::format("  distortion_coefficients: [{}]\n", fmt::join(keys.distortion_coefficients, ", "));
  }
  if (camera.port) text += fmt::format("  port: {}\n", portText(*camera.port));
  if (camera.time_offset_to_imu_s != 0.0) {
    text += fmt::format("  timeshift_cam_imu: {}\n", camera.time_offset_to_imu_s);
  }
  text += shutterText(camera, "  ");
  if (!camera.mask_file.empty()) {
    text += fmt::format("  mask: {}\n", std::filesystem::absolute(camera.mask_file).string());
  }
  return text + rateText(camera.rate_hz);
}

std::string correctionText(const ImuCorrection& correction) {
  std::string text = "  gyroscopes:  # reading = M w + A f + bias\n" +
                     matrixText("M", correction.gyroscope.inverse()) +
                     matrixText("A", correction.g_sensitivity) + biasText(correction.gyroscope_bias);
  text += "  accelerometers:  # reading = M f + bias\n" +
          matrixText("M", correction.accelerometer.inverse()) + biasText(correction.accelerometer_bias);
  if (correction.time_offset_s != 0.0) text += fmt::format("  time_offset: {}\n", correction.time_offset_s);
  return text;
}

std::string sonarText(const SonarCalibration& sonar) {
  std::string text = transformText(sonar.body_from_sonar) +
                     fmt::format("  range_noise_std: {}  # m\n  beam_width: {}  # rad\n",
                                 sonar.range_noise_std_m, sonar.beam_width_rad);
  if (sonar.max_range_m > 0.0) text += fmt::format("  max_range: {}  # m\n", sonar.max_range_m);
  return text + rateText(sonar.rate_hz);
}

std::string dvlText(const DvlCalibration& dvl) {
  std::string text = fmt::format("  velocity_noise_std: {}  # m/s\n  range_noise_std: {}  # m\n  beams:\n",
                                 dvl.velocity_noise_std_m_per_s, dvl.range_noise_std_m);
  for (const Vec3& beam : dvl.beams_D)
    text += fmt::format("    - [{}, {}, {}]\n", beam.x(), beam.y(), beam.z());
  text += fmt::format("  scale_sigma: {}\n  misalignment_sigma: {}  # rad\n", dvl.scale_sigma,
                      dvl.misalignment_sigma_rad);
  if (dvl.time_offset_to_imu_s != 0.0)
    text += fmt::format("  timeshift: {}  # s\n", dvl.time_offset_to_imu_s);
  return text;
}

std::string currentText(const CurrentCalibration& currents) {
  std::string text;
  if (!currents.channels.empty()) text += "  channels:\n";
  for (size_t i = 0; i < currents.channels.size(); ++i) {
    const YAML::Node name(currents.channels[i]);  // quoted where YAML needs it
    if (currents.fields_T_per_A.empty()) {
      text += fmt::format("    - {}\n", YAML::Dump(name));
      continue;
    }
    const Vec3& k = currents.fields_T_per_A[i];
    text += fmt::format("    {}: {{field_T_per_A: [{}, {}, {}]}}\n", YAML::Dump(name), k.x(), k.y(), k.z());
  }
  if (currents.field_sigma_T_per_A > 0.0)
    text += fmt::format("  field_sigma_T_per_A: {}\n", currents.field_sigma_T_per_A);
  if (currents.time_offset_to_imu_s != 0.0)
    text += fmt::format("  timeshift: {}  # s\n", currents.time_offset_to_imu_s);
  return text;
}

std::string imuText(const ImuCalibration& imu, const std::optional<ImuCorrection>& correction) {
  const ImuNoise& noise = imu.noise;
  std::string text = fmt::format(
      "  gyroscope_noise_density: {}  # rad/s/sqrt(Hz)\n  gyroscope_random_walk: {}  # rad/s^2/sqrt(Hz)\n"
      "  accelerometer_noise_density: {}  # m/s^2/sqrt(Hz)\n  accelerometer_random_walk: {}  # "
      "m/s^3/sqrt(Hz)\n",
      noise.gyroscope_density_rad_per_s_sqrtHz, noise.gyroscope_random_walk_rad_per_s2_sqrtHz,
      noise.accelerometer_density_m_per_s2_sqrtHz, noise.accelerometer_random_walk_m_per_s3_sqrtHz);
  if (noise.axes_sigma)
    text += fmt::format("  axes_sigma: {}  # scale errors and misalignment of the axes, relative and rad\n",
                        *noise.axes_sigma);
  if (correction) text += correctionText(*correction);
  return text + rateText(imu.rate_hz);
}

}  // namespace

std::string rigText(const RigFile& file) {
  const Rig& rig = file.rig;
  std::string text =
      "# Rig file of Lodeline (docs/reference/file-formats.md). T_BS takes sensor to IMU coordinates.\n";
  const auto begin = [&](const std::string& sensor) {
    text += sensor + ":\n";
    const auto topic = file.topics.find(sensor);
    if (topic != file.topics.end()) text += fmt::format("  topic: {}\n", topic->second);
  };
  for (const CameraCalibration& camera : rig.cameras) {
    begin(camera.name);
    text += cameraText(camera, !file.without_extrinsics.contains(camera.name));
  }
  if (file.has_imu) {
    begin("imu0");
    text += imuText(rig.imu, file.imu_correction);
  }
  if (rig.magnetometer) {
    begin("mag0");
    text += transformText(rig.magnetometer->body_from_magnetometer) +
            fmt::format("  magnetometer_noise_density: {}  # T/sqrt(Hz)\n",
                        rig.magnetometer->noise_density_T_per_sqrtHz) +
            rateText(rig.magnetometer->rate_hz);
  }
  if (rig.pressure) {
    begin("pressure0");
    text +=
        transformText(rig.pressure->body_from_pressure) +
        fmt::format("  depth_noise_std: {}  # m\n  water_density_kg_per_m3: {}\n  surface_pressure_Pa: {}\n",
                    rig.pressure->depth_noise_std_m, file.water.density_kg_per_m3,
                    file.water.surface_pressure_Pa) +
        rateText(rig.pressure->rate_hz);
  }
  if (rig.sonar) {
    begin("sonar0");
    text += sonarText(*rig.sonar);
  }
  if (rig.altimeter) {
    begin("altimeter0");
    text += sonarText(*rig.altimeter);
  }
  if (rig.dvl) {
    begin("dvl0");
    text += transformText(rig.dvl->body_from_dvl) + dvlText(*rig.dvl) + rateText(rig.dvl->rate_hz);
  }
  if (rig.currents) {
    begin("current0");
    // A section without a key is no map.
    const std::string keys = currentText(*rig.currents) + rateText(rig.currents->rate_hz);
    text += keys.empty() ? "  field_sigma_T_per_A: 0\n" : keys;
  }
  return text;
}

std::string rigTemplate() {
  return R"(# Rig file of Lodeline (docs/reference/file-formats.md): one section a sensor. Replace the numbers, remove what the rig lacks.
# Use: lodeline run DATA -o OUT --rig rig.yaml

cam0:                               # cameras: cam0, cam1, … without gaps; cam0 is the reference
  topic: /cam0/image_raw            # in a bag; may be left out where only one topic fits
  T_BS:                             # camera to IMU coordinates: p_imu = T_BS p_camera, translation in m.
    - [1.0, 0.0, 0.0, 0.0]          # Kalibr's T_cam_imu is its inverse; OpenVINS's T_imu_cam, VINS's body_T_cam0,
    - [0.0, 1.0, 0.0, 0.0]          # ORB-SLAM3's T_b_c1 and OKVIS's T_SC are the same
    - [0.0, 0.0, 1.0, 0.0]
    - [0.0, 0.0, 0.0, 1.0]
  resolution: [752, 480]            # width, height, px
  intrinsics: [458.0, 457.0, 367.0, 248.0]  # fx, fy, cx, cy, px
  # camera_model: ds                # pinhole where it is missing; omni, ds, eucm: intrinsics as Kalibr's
  distortion_model: radial-tangential       # radial-tangential (4, 5 or 8 numbers), equidistant (4), fov (1) or none
  distortion_coefficients: [-0.28, 0.07, 0.0002, 0.00002]  # k1, k2, p1, p2 [, k3 [, k4, k5, k6]]
  # port: {type: flat, distance_m: 0.015, thickness_m: 0.008}  # a housing's window; intrinsics are those in air
  timeshift_cam_imu: 0.0            # s; stamp of an image + this = IMU clock
  rate_hz: 20
  # mask: cam0_mask.png             # beside this file; zero where the camera sees its own rig

cam1:                               # remove for one camera
  topic: /cam1/image_raw
  T_BS:
    - [1.0, 0.0, 0.0, 0.1]
    - [0.0, 1.0, 0.0, 0.0]
    - [0.0, 0.0, 1.0, 0.0]
    - [0.0, 0.0, 0.0, 1.0]
  resolution: [752, 480]
  intrinsics: [458.0, 457.0, 367.0, 248.0]
  distortion_model: radial-tangential
  distortion_coefficients: [-0.28, 0.07, 0.0002, 0.00002]

imu0:                               # continuous noise densities: a datasheet's, or from `lodeline allan`
  topic: /imu0
  gyroscope_noise_density: 1.7e-04      # rad/s/sqrt(Hz)
  gyroscope_random_walk: 2.0e-05        # rad/s^2/sqrt(Hz)
  accelerometer_noise_density: 2.0e-03  # m/s^2/sqrt(Hz)
  accelerometer_random_walk: 3.0e-03    # m/s^3/sqrt(Hz)
  rate_hz: 200
  # Scale and misalignment, where they are calibrated: reading = M C_gyro_i w + A f, reading = M f
  # gyroscopes: {M: [1,0,0, 0,1,0, 0,0,1], C_gyro_i: [1,0,0, 0,1,0, 0,0,1], A: [0,0,0, 0,0,0, 0,0,0]}
  # accelerometers: {M: [1,0,0, 0,1,0, 0,0,1]}

# mag0:
#   topic: /imu/mag
#   T_BS: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]
#   magnetometer_noise_density: 1.0e-08     # T/sqrt(Hz)

# pressure0:
#   topic: /pressure
#   T_BS: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]
#   depth_noise_std: 0.02                   # m
#   water_density_kg_per_m3: 1000           # sea water 1025
#   surface_pressure_Pa: 101325

# sonar0:
#   topic: /sonar
#   T_BS: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]
#   range_noise_std: 0.05                   # m
#   beam_width: 0.035                       # rad, full width

# altimeter0:                               # its beam points along x; keys as sonar0
#   topic: /altimeter
#   T_BS: [0,0,1,0, 0,1,0,0, -1,0,0,0, 0,0,0,1]
#   range_noise_std: 0.05                   # m
#   max_range: 50                           # m; greater ranges are no echoes

# dvl0:                                     # z points along the axis of the beams, from the instrument outwards
#   topic: /dvl/data
#   T_BS: [1,0,0,0, 0,-1,0,0, 0,0,-1,0, 0,0,0,1]
#   velocity_noise_std: 0.01                # m/s
#   range_noise_std: 0.05                   # m
#   beams: {angle_deg: 22.5, azimuths_deg: [45, 135, 225, 315]}  # to z; from x towards y; or vectors [x, y, z]
#   scale_sigma: 0.01                       # of the speed of sound, relative
#   misalignment_sigma: 0.03                # rad
#   timeshift: 0.0                          # s; stamp + this = IMU clock

# current0:                                 # currents that disturb mag0; names as in the recording
#   topic: /currents
#   channels:                               # or names alone: [thruster_1, lamp]
#     thruster_1: {field_T_per_A: [1.2e-07, -3.0e-08, 4.0e-08]}  # axes of the magnetometer
#     lamp: {field_T_per_A: [0, 0, 2.0e-08]}
#   field_sigma_T_per_A: 5.0e-09
#   timeshift: 0.0                          # s
)";
}

}  // namespace lodeline
