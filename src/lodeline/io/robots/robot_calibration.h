#pragma once

#include <string>

#include "lodeline/io/calibration/yaml_file.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Reads the section dvl0 of a rig file, or dvl0/sensor.yaml:
///
///     T_BS: …
///     velocity_noise_std: 0.01   # m/s
///     range_noise_std: 0.05      # m
///     beams: {angle_deg: 22.5, azimuths_deg: [45, 135, 225, 315]}   # or a list of vectors [x, y, z]
///     scale_sigma: 0.01          # relative
///     misalignment_sigma: 0.03   # rad
///     timeshift: 0.0             # s; stamp + this = IMU clock
///
/// T_BS and velocity_noise_std are necessary. Throws InputError for wrong values.
DvlCalibration readDvlSection(CalibrationMap* map);

/// Reads the section current0: `channels`, by name in their order, with the field of each current, or the
/// names alone:
///
///     channels:
///       thruster_1: {field_T_per_A: [1.2e-07, -3.0e-08, 4.0e-08]}
///       lamp: {field_T_per_A: [0, 0, 2.0e-08]}
///     field_sigma_T_per_A: 5.0e-09
///     timeshift: 0.0             # s
///
/// Throws InputError for wrong values, and where only some of the channels have a field.
CurrentCalibration readCurrentSection(CalibrationMap* map);

/// The keys of both sections, without the name of the section, T_BS, topic and rate.
std::string dvlSectionText(const DvlCalibration& dvl);
std::string currentSectionText(const CurrentCalibration& currents);

}  // namespace lodeline
