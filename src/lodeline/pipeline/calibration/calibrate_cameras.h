#pragma once

#include <filesystem>
#include <string>

#include "lodeline/recording.h"
#include "lodeline/rig_calibration/result/rig_calibration.h"

namespace lodeline {

struct CameraCalibrationRequest {
  CalibrationBoard board;
  BoardRecordOptions record;
  RigCalibrationOptions options;
  bool without_ports = false;  ///< ignores the stated ports
};

struct CameraCalibrationOutcome {
  std::string text;          ///< report for the user
  std::string poor_because;  ///< the first reason against a poor calibration; empty for others
};

/// Calibrates the cameras of a recording, and writes rig.yaml, camchain-imucam.yaml (camchain.yaml without
/// IMU), calibration.json, report.txt, report.html and figures to `folder`. Throws as readBoardRecord() and
/// calibrateRig() do, and then writes nothing.
CameraCalibrationOutcome calibrateCameras(RecordedSource* source, const CameraCalibrationRequest& request,
                                          const std::filesystem::path& folder, Diagnostics* diagnostics);

}  // namespace lodeline
