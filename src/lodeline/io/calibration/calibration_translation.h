#pragma once

#include <map>
#include <string>
#include <vector>

#include "lodeline/cameras/camera_model.h"
#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/yaml_file.h"

namespace lodeline {

/// Sections of a rig by sensor (cam0, …, imu0), with the keys of a rig file (see readRigFiles).
using TranslatedSections = std::map<std::string, YAML::Node>;

/// Functions that translate calibrations of other programs to the keys of a rig file. They copy numbers as
/// written wherever the meaning is the same. `T_BS` transforms camera to IMU coordinates. So do `body_T_camN`
/// (VINS-Fusion), `extrinsicRotation` and `extrinsicTranslation` (VINS-Mono), `IMU.T_b_c1` and `Tbc`
/// (ORB-SLAM3), `T_SC` (OKVIS) and `T_imu_cam` (Basalt). All functions throw InputError naming file and key
/// for missing values and for camera models that Lodeline does not have.

/// VINS gives the noise per reading, at a rate that its files do not contain. The function assumes 200 Hz and
/// reports it (`calibration_assumed`). Values too small for that are taken as densities, which it also
/// reports.
TranslatedSections translateVins(CalibrationMap* root, Diagnostics* diagnostics);
/// Translates one camera without extrinsics.
YAML::Node translateVinsCamera(CalibrationMap* root);

/// ORB-SLAM3 gives the noise as densities. The function refuses files of version 0 with stereo images that
/// ORB-SLAM3 rectifies itself (`LEFT.K`), because they do not state the camera of `Tbc`.
TranslatedSections translateOrbSlam(CalibrationMap* root);

TranslatedSections translateOkvis(CalibrationMap* root);

TranslatedSections translateBasalt(CalibrationMap* root);

/// Translates one camera without extrinsics: the file of ROS's calibrator, a printed sensor_msgs/CameraInfo,
/// or the file of OpenCV's calibration sample.
YAML::Node translateCameraInfo(CalibrationMap* root);

/// Writes the names of a model to the section of a camera.
void setCameraModel(const CameraModel& model, YAML::Node* camera);
/// The numbers under several keys as one list, copied as written.
YAML::Node numbersUnder(const std::vector<std::string>& keys, CalibrationMap* map);
/// The list of numbers under a key, copied as written. Throws InputError where it does not have `count`
/// numbers.
YAML::Node numbersAsWritten(const std::string& key, size_t count, CalibrationMap* map);
/// A YAML list of numbers with all their digits.
YAML::Node numberList(const std::vector<double>& numbers);
/// A transformation as 16 numbers, row by row.
YAML::Node transformNode(const Rigid3& transform);

}  // namespace lodeline
