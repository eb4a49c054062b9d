#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/ahrs/field_unit.h"
#include "lodeline/io/synchronizer/measurement_source.h"
#include "lodeline/sensors/measurements.h"
#include "lodeline/sensors/rig.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

struct RecordOptions {
  std::optional<FieldUnit> unit;  ///< of the magnetometer's columns; else as stated, or told by size
  /// The part to use, counted from the first magnetometer reading.
  double from_s = 0.0;
  std::optional<double> to_s;
};

/// What a calibration starts from.
struct MagnetometerRecord {
  std::vector<MagnetometerSample> magnetometer;  ///< T, or counts where `is_raw`
  std::vector<ImuSample> imu;                    ///< empty where there is none
  ImuNoise imu_noise;
  std::optional<Quat> body_from_magnetometer;  ///< as the recording states it
  bool is_raw = false;
  bool has_times = true;  ///< false: rows in order, stamps made up
};

/// Reads a folder in the EuRoC ASL layout (mav0/mag0, and mav0/imu0 where it is there; neither needs a
/// sensor.yaml), or a table (PlainCsv): with a header, of which columns x, y, z may be the magnetometer's, or
/// rows of `t mx my mz` or `mx my mz` without one. A unit that is not stated is told by the field's size, and
/// one that contradicts it is corrected, both with a warning. Throws InputError where there are no
/// magnetometer readings, and UsageError where a part is asked for that is empty or cannot be found without
/// times.
MagnetometerRecord readMagnetometerRecord(const std::filesystem::path& data, const RecordOptions& options,
                                          Diagnostics* diagnostics);

/// The same from a recording that is open already, of which the readings are pulled to their end. `name`: for
/// messages; `is_mounting_known`: whether the rig's rotation of the magnetometer is more than a default.
MagnetometerRecord readMagnetometerRecord(MeasurementSource& source, const std::string& name,
                                          bool is_mounting_known, const RecordOptions& options,
                                          Diagnostics* diagnostics);

}  // namespace lodeline
