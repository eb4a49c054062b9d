#pragma once

#include <map>
#include <string>
#include <vector>

#include "lodeline/io/calibration/yaml_file.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// Sections of a rig by sensor (cam0, …, imu0), in the keys of a rig file (see readRigFiles).
using TranslatedSections = std::map<std::string, YAML::Node>;

/// Translations of other programs' calibrations into our keys, numbers as they are written wherever they mean
/// the same. `T_BS` takes camera to IMU coordinates, as do `body_T_camN` (VINS-Fusion), `extrinsicRotation`
/// and `extrinsicTranslation` (VINS-Mono), `IMU.T_b_c1` and `Tbc` (ORB-SLAM3), `T_SC` (OKVIS) and `T_imu_cam`
/// (Basalt). All throw InputError naming file and key for what is missing, and for camera models that
/// Lodeline does not have.

/// VINS states noise per reading, at a rate that its files do not hold: 200 Hz is assumed and reported
/// (`calibration_assumed`). Figures too small for that are taken as densities, which is reported too.
TranslatedSections translateVins(CalibrationMap* root, Diagnostics* diagnostics);
/// One camera without extrinsics.
YAML::Node translateVinsCamera(CalibrationMap* root);

/// Noise is stated as densities. Files of version 0 for stereo images that ORB-SLAM3 is to rectify (`LEFT.K`)
/// are refused: they do not say of which camera `Tbc` is.
TranslatedSections translateOrbSlam(CalibrationMap* root);

TranslatedSections translateOkvis(CalibrationMap* root);

/// Camera types pinhole, pinhole-radtan8 and kb4; ds, eucm and others are refused.
TranslatedSections translateBasalt(CalibrationMap* root);

/// One camera without extrinsics: the file of ROS's calibrator, a printed sensor_msgs/CameraInfo, or the file
/// of OpenCV's calibration sample.
YAML::Node translateCameraInfo(CalibrationMap* root);

/// The numbers under several keys as one list, as they are written.
YAML::Node numbersUnder(const std::vector<std::string>& keys, CalibrationMap* map);
/// The numbers under a key in a row, as they are written. Throws InputError where they are not `count`
/// numbers.
YAML::Node numbersAsWritten(const std::string& key, size_t count, CalibrationMap* map);
/// A list of numbers, with all their digits.
YAML::Node numberList(const std::vector<double>& numbers);
/// 16 numbers, row by row.
YAML::Node transformNode(const Rigid3& transform);

}  // namespace lodeline
