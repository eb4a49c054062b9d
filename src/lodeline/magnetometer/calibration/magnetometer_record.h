#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/ahrs/field_unit.h"
#include "lodeline/diagnostics.h"
#include "lodeline/recording.h"
#include "lodeline/rig.h"
#include "lodeline/util/terminal/progress.h"

namespace lodeline {

struct RecordOptions {
  std::optional<FieldUnit> unit;  ///< nothing: as stated, or from the magnitude
  /// Part to use, counted from the first magnetometer reading.
  double from_s = 0.0;
  std::optional<double> to_s;
  ShareDone progress = [](double) {};  ///< takes the share that is read
};

/// Input data of a calibration.
struct MagnetometerRecord {
  std::vector<MagnetometerSample> magnetometer;  ///< T, or counts where `is_raw`
  std::vector<ImuSample> imu;                    ///< empty where there are none
  ImuNoise imu_noise;
  std::optional<Quat> body_from_magnetometer;  ///< as stated in the recording
  bool is_raw = false;
  bool has_times = true;  ///< false: the stamps only number the rows
};

/// Reads the magnetometer and, where it exists, the IMU from a recording or a table. `data` is a folder in
/// the EuRoC ASL layout (mav0/mag0 and mav0/imu0, no sensor.yaml required) or a sensor log. A table
/// with a header may have the magnetometer in columns x, y, z. Without a header, its rows are `t mx my mz` or
/// `mx my mz`. A missing unit is determined from the field magnitude, and a contradicting one is corrected,
/// both with a warning. Throws InputError where there are no magnetometer readings. Throws UsageError where
/// the requested part is empty or needs times that do not exist.
MagnetometerRecord readMagnetometerRecord(const std::filesystem::path& data, const RecordOptions& options,
                                          Diagnostics* diagnostics);

/// Reads the record from an open recording; pulls its readings to the end. `name`: for messages.
/// `is_mounting_known`: whether the rig's rotation of the magnetometer is more than a default.
MagnetometerRecord readMagnetometerRecord(MeasurementSource& source, const std::string& name,
                                          bool is_mounting_known, const RecordOptions& options,
                                          Diagnostics* diagnostics);

}  // namespace lodeline
