#pragma once

#include <yaml-cpp/yaml.h>

#include <string>

namespace lodeline {

/// The program or format that a calibration file belongs to, determined from its keys and not from its name.
enum class CalibrationKind {
  Rig,                ///< sections cam0, imu0, …: Lodeline's rig file, Kalibr's camchain, OpenVINS's chains
  ImuKeys,            ///< IMU keys at the top level: Kalibr's imu.yaml, EuRoC's sensor.yaml
  CameraKeys,         ///< camera keys at the top level: EuRoC's sensor.yaml, Kimera
  OpenVinsEstimator,  ///< estimator_config.yaml, which refers to two files
  Vins,               ///< VINS-Fusion, VINS-Mono
  VinsCamera,         ///< a single-camera file to which VINS-Fusion's main file refers (camodocal)
  OrbSlam,            ///< settings of ORB-SLAM3
  Okvis,              ///< OKVIS, OKVIS2
  Basalt,
  CameraInfo,  ///< ROS's camera_info, and the output of OpenCV's calibration sample
  Other,
};

CalibrationKind recognizeCalibration(const YAML::Node& root);

/// Description of a kind that fits after "is ".
const char* describe(CalibrationKind kind);

/// Message for a file of the kind Other: its probable content, its keys, and what to give instead.
std::string describeOther(const YAML::Node& root);

/// Whether a rig file's key names a camera (cam0, cam1, …), and whether it names any sensor.
bool isCameraName(const std::string& key);
bool isSensorName(const std::string& key);

}  // namespace lodeline
