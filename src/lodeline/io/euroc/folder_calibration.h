#pragma once

#include "lodeline/io/calibration/rig_file.h"
#include "lodeline/io/euroc/euroc_rig.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// Reads the calibration of a recording's sensors (those that have a `data.csv`). Of several places the first
/// that describes a sensor counts:
///
/// 1. `layout.rig_files`;
/// 2. Kalibr's or OpenVINS's files by their names (`camchain-imucam.yaml`, `kalibr_imucam_chain.yaml`,
/// `imu.yaml`,
///    `kalibr_imu_chain.yaml`, a recording's name before or after), beside mav0 or in it (`kalibr_used`,
///    where a sensor.yaml is there too);
/// 3. the sensor's `sensor.yaml`;
/// 4. for cameras or an IMU that still lack one: any calibration beside mav0, in it, or in a folder beside
/// it, told
///    by its content, where there is one only (`calibration_found`).
///
/// Throws InputError, naming the files that were looked at and what to give, where a camera or the IMU has
/// none and `layout.needs_calibration`; otherwise such sensors are left out and reported
/// (`imu0_uncalibrated`, …).
RigFile readFolderCalibration(const EurocLayout& layout, Diagnostics* diagnostics);

}  // namespace lodeline
