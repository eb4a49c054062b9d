#pragma once

#include "lodeline/diagnostics.h"
#include "lodeline/io/calibration/rig_file.h"
#include "lodeline/io/euroc/euroc_rig.h"

namespace lodeline {

/// Reads the calibration of a recording's sensors (those that have a `data.csv`). The first of these places
/// that describes a sensor has priority:
///
/// 1. `layout.rig_files`;
/// 2. Kalibr's or OpenVINS's files beside mav0 or in it (`kalibr_used`, where a sensor.yaml exists too): by
///    the names `camchain-imucam.yaml`, `kalibr_imucam_chain.yaml`, `imu.yaml`, `kalibr_imu_chain.yaml`, with
///    a recording's name before or after;
/// 3. the sensor's `sensor.yaml`;
/// 4. for cameras or an IMU that still lack one: the only calibration file beside mav0, in it, or in a folder
///    beside it, identified by its content (`calibration_found`).
///
/// Where a camera or the IMU has no calibration and `layout.needs_calibration` is set, it throws InputError
/// naming the examined files and the remedy. Otherwise it leaves such sensors out and reports them
/// (`imu0_uncalibrated`, …).
RigFile readFolderCalibration(const EurocLayout& layout, Diagnostics* diagnostics);

}  // namespace lodeline
