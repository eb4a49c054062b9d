#pragma once

#include <fmt/format.h>

#include <array>
#include <string>

/// The calibration of EuRoC's rig (machine hall) as sections of a rig file, and its numbers for files in
/// other programs' formats.
namespace lodeline::test {

inline constexpr const char* kLeftPose =
    "0.0148655429818, -0.999880929698, 0.00414029679422, -0.0216401454975, 0.999557249008, 0.0149672133247, "
    "0.025715529948, -0.064676986768, -0.0257744366974, 0.00375618835797, 0.999660727178, 0.00981073058949, "
    "0.0, 0.0, 0.0, 1.0";
inline constexpr const char* kRightPose =
    "0.0125552670891, -0.999755099723, 0.0182237714554, -0.0198435579556, 0.999598781151, 0.0130119051815, "
    "0.0251588363115, 0.0453689425024, -0.0253898008918, 0.0179005838253, 0.999517347078, 0.00786212447038, "
    "0.0, 0.0, 0.0, 1.0";
/// Transformations from the IMU to the cameras, and from the right camera to the left one.
inline constexpr const char* kLeftFromImu =
    "0.0148655429818, 0.999557249008, -0.0257744366974, 0.0652229095355, -0.999880929699, 0.0149672133247, "
    "0.00375618835797, -0.0207063854927, 0.00414029679422, 0.025715529948, 0.999660727178, "
    "-0.00805460246003, "
    "0, 0, 0, 1";
inline constexpr const char* kRightFromLeft =
    "0.999997256478, 0.00231206719242, 0.000376008102416, -0.110073808127, -0.00231713572328, "
    "0.999898048507, "
    "0.0140898358466, 0.000399121547014, -0.000343393120524, -0.0140906684527, 0.999900662638, "
    "-0.000853702503358, 0, 0, 0, 1";
inline constexpr std::array kPoses = {kLeftPose, kRightPose};
inline constexpr std::array kIntrinsics = {"458.654, 457.296, 367.215, 248.375",
                                           "457.587, 456.134, 379.999, 255.238"};
inline constexpr std::array kDistortion = {"-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05",
                                           "-0.28368365, 0.07451284, -0.00010473, -3.55590700e-05"};

inline constexpr const char* kEurocImu =
    "imu0:\n  rate_hz: 200\n  gyroscope_noise_density: 1.6968e-04\n  gyroscope_random_walk: 1.9393e-05\n"
    "  accelerometer_noise_density: 2.0000e-3\n  accelerometer_random_walk: 3.0000e-3\n";

/// Text of a Lodeline rig file.
inline std::string eurocRig() {
  std::string text = kEurocImu;
  for (size_t i = 0; i < 2; ++i) {
    text += fmt::format(
        "cam{}:\n  T_BS: [{}]\n  rate_hz: 20\n  resolution: [752, 480]\n  intrinsics: [{}]\n"
        "  distortion_model: radial-tangential\n  distortion_coefficients: [{}]\n",
        i, kPoses[i], kIntrinsics[i], kDistortion[i]);
  }
  return text;
}

/// Text of Kalibr's camchain (`key` T_cam_imu) or OpenVINS's (T_imu_cam), with the pose of cam0 under `key`.
inline std::string eurocChain(const std::string& key, const std::string& left_pose,
                              const std::string& right_key, const std::string& right_pose) {
  std::string text;
  for (size_t i = 0; i < 2; ++i) {
    text += fmt::format(
        "cam{}:\n  {}: [{}]\n  cam_overlaps: [1]\n  camera_model: pinhole\n  distortion_coeffs: [{}]\n"
        "  distortion_model: radtan\n  intrinsics: [{}]\n  resolution: [752, 480]\n  rostopic: "
        "/cam{}/image_raw\n",
        i, i == 0 ? key : right_key, i == 0 ? left_pose : right_pose, kDistortion[i], kIntrinsics[i], i);
  }
  return text;
}

inline constexpr const char* kKalibrImu =
    "rostopic: /imu0\nupdate_rate: 200.0\naccelerometer_noise_density: 2.0e-03\n"
    "accelerometer_random_walk: 3.0e-03\ngyroscope_noise_density: 1.6968e-04\ngyroscope_random_walk: "
    "1.9393e-05\n";

/// Text of VINS-Fusion's main file (`noise`: its four values) and of a camera file.
inline std::string eurocVins(const std::string& noise) {
  return fmt::format(
      "%YAML:1.0\nimu: 1\nnum_of_cam: 2\nimu_topic: \"/imu0\"\nimage0_topic: \"/cam0/image_raw\"\n"
      "image1_topic: \"/cam1/image_raw\"\ncam0_calib: \"cam0_pinhole.yaml\"\ncam1_calib: "
      "\"cam1_pinhole.yaml\"\n"
      "image_width: 752\nimage_height: 480\nestimate_extrinsic: 0\n"
      "body_T_cam0: !!opencv-matrix\n   rows: 4\n   cols: 4\n   dt: d\n   data: [{}]\n"
      "body_T_cam1: !!opencv-matrix\n   rows: 4\n   cols: 4\n   dt: d\n   data: [{}]\nmax_cnt:150\n{}td: "
      "0.0\n",
      kLeftPose, kRightPose, noise);
}

inline std::string eurocVinsCamera(size_t i) {
  std::array<std::string, 4> k, d;
  const auto split = [](const std::string& text, std::array<std::string, 4>* parts) {
    size_t begin = 0;
    for (std::string& part : *parts) {
      const size_t end = std::min(text.find(", ", begin), text.size());
      part = text.substr(begin, end - begin);
      begin = end + 2;
    }
  };
  split(kIntrinsics[i], &k);
  split(kDistortion[i], &d);
  return fmt::format(
      "%YAML:1.0\n---\nmodel_type: PINHOLE\ncamera_name: camera\nimage_width: 752\nimage_height: 480\n"
      "distortion_parameters:\n   k1: {}\n   k2: {}\n   p1: {}\n   p2: {}\n"
      "projection_parameters:\n   fx: {}\n   fy: {}\n   cx: {}\n   cy: {}\n",
      d[0], d[1], d[2], d[3], k[0], k[1], k[2], k[3]);
}

inline std::string eurocOrbSlam() {
  return fmt::format(
      "%YAML:1.0\nFile.version: \"1.0\"\nCamera.type: \"PinHole\"\n"
      "Camera1.fx: 458.654\nCamera1.fy: 457.296\nCamera1.cx: 367.215\nCamera1.cy: 248.375\n"
      "Camera1.k1: -0.28340811\nCamera1.k2: 0.07395907\nCamera1.p1: 0.00019359\nCamera1.p2: 1.76187114e-05\n"
      "Camera2.fx: 457.587\nCamera2.fy: 456.134\nCamera2.cx: 379.999\nCamera2.cy: 255.238\n"
      "Camera2.k1: -0.28368365\nCamera2.k2: 0.07451284\nCamera2.p1: -0.00010473\nCamera2.p2: "
      "-3.55590700e-05\n"
      "Camera.width: 752\nCamera.height: 480\nCamera.newWidth: 600\nCamera.fps: 20\nViewer.PointSize:2\n"
      "Stereo.T_c1_c2: !!opencv-matrix\n  rows: 4\n  cols: 4\n  dt: f\n"
      "  data: [0.99999725647745,-0.00231713572328462,-0.000343393120588828,0.11007413780044,"
      "0.00231206719242016,0.999898048506528,-0.0140906684526704,-0.000156612054392761,"
      "0.000376008102350993,0.0140898358466973,0.999900662638179,0.000889382785435722,0,0,0,1.0]\n"
      "IMU.T_b_c1: !!opencv-matrix\n  rows: 4\n  cols: 4\n  dt: f\n  data:[{}]\n"
      "IMU.NoiseGyro: 1.6968e-04\nIMU.NoiseAcc: 2.0000e-3\nIMU.GyroWalk: 1.9393e-05\nIMU.AccWalk: 3.0000e-3\n"
      "IMU.Frequency: 200.0\n",
      kLeftPose);
}

inline std::string eurocOkvis() {
  std::string text = "%YAML:1.0\ncameras:\n";
  constexpr std::array kFocal = {"458.654, 457.296", "457.587, 456.134"};
  constexpr std::array kCentre = {"367.215, 248.375", "379.999, 255.238"};
  for (size_t i = 0; i < 2; ++i) {
    text += fmt::format(
        "     - {{T_SC:\n        [ {}],\n        image_dimension: [752, 480],\n        "
        "distortion_coefficients: "
        "[{}],\n        distortion_type: radialtangential,\n        focal_length: [{}],\n        "
        "principal_point: [{}], camera_type: gray, slam_use: okvis}}\n",
        kPoses[i], kDistortion[i], kFocal[i], kCentre[i]);
  }
  return text +
         "camera_parameters:\n    image_delay: 0.00\nimu_parameters:\n    use: true\n    a_max: 176.0\n"
         "    sigma_g_c: 1.6968e-04\n    sigma_a_c: 2.0e-3\n    sigma_gw_c: 1.9393e-05\n    sigma_aw_c: "
         "3.0e-3\n"
         "    a0: [ -0.05, 0.09, 0.01 ]\n";
}

inline std::string eurocBasalt() {
  return R"({"value0": {
    "T_imu_cam": [
      {"px": -0.0216401454975, "py": -0.064676986768, "pz": 0.00981073058949,
       "qx": -0.0077071797555383, "qy": 0.0104993233705885, "qz": 0.701752800292051, "qw": 0.712301460669034},
      {"px": -0.0198435579556, "py": 0.0453689425024, "pz": 0.00786212447038,
       "qx": -0.00255023674517002, "qy": 0.0153239274879774, "qz": 0.702486685782491, "qw": 0.711527321918996}],
    "intrinsics": [
      {"camera_type": "pinhole-radtan8", "intrinsics": {"fx": 458.654, "fy": 457.296, "cx": 367.215, "cy": 248.375,
       "k1": -0.28340811, "k2": 0.07395907, "p1": 0.00019359, "p2": 1.76187114e-05, "k3": 0, "k4": 0, "k5": 0,
       "k6": 0, "rpmax": 0}},
      {"camera_type": "pinhole-radtan8", "intrinsics": {"fx": 457.587, "fy": 456.134, "cx": 379.999, "cy": 255.238,
       "k1": -0.28368365, "k2": 0.07451284, "p1": -0.00010473, "p2": -3.55590700e-05, "k3": 0, "k4": 0, "k5": 0,
       "k6": 0, "rpmax": 0}}],
    "resolution": [[752, 480], [752, 480]],
    "calib_accel_bias": [0, 0, 0, 0, 0, 0, 0, 0, 0],
    "calib_gyro_bias": [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0],
    "imu_update_rate": 200.0, "accel_noise_std": [0.002, 0.002, 0.002], "gyro_noise_std": [0.00016968, 0.00016968,
    0.00016968], "accel_bias_std": [0.003, 0.003, 0.003], "gyro_bias_std": [1.9393e-05, 1.9393e-05, 1.9393e-05],
    "cam_time_offset_ns": 0, "vignette": []}})";
}

}  // namespace lodeline::test
