#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

namespace lodeline {

/// Who wrote a calibration, as its keys tell; names of files say nothing.
enum class CalibrationKind {
  Rig,                ///< sections cam0, imu0, …: our own, Kalibr's camchain, OpenVINS's chains
  ImuKeys,            ///< an IMU's keys at the top: Kalibr's imu.yaml, EuRoC's sensor.yaml
  CameraKeys,         ///< a camera's keys at the top: EuRoC's sensor.yaml, Kimera
  OpenVinsEstimator,  ///< estimator_config.yaml, which names two files
  Vins,               ///< VINS-Fusion, VINS-Mono
  VinsCamera,         ///< the file of one camera that VINS-Fusion's names (camodocal)
  OrbSlam,            ///< settings of ORB-SLAM3
  Okvis,              ///< OKVIS, OKVIS2
  Basalt,
  CameraInfo,  ///< ROS's camera_info, and what OpenCV's calibration sample writes
  Other,
};

CalibrationKind recognizeCalibration(const YAML::Node& root);

/// In words that fit behind "is ".
const char* describe(CalibrationKind kind);

/// For a file of the kind Other: what it looks like, its keys, and what to give.
std::string describeOther(const YAML::Node& root);

/// Whether a key of a rig file is a camera (cam0, cam1, …), and whether it is any sensor.
bool isCameraName(const std::string& key);
bool isSensorName(const std::string& key);

}  // namespace lodeline
