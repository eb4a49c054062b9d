#pragma once

#include <optional>
#include <vector>

#include "lodeline/ahrs/field_unit.h"
#include "lodeline/inspection/survey/stream_survey.h"
#include "lodeline/io/synchronizer/measurement_source.h"

namespace lodeline {

/// How the magnetometer fits the gyroscope: turned back by the gyroscope, the field must stand still.
struct FieldTurning {
  double scatter = 0.0;       ///< of the field turned back, relative to its size, as recorded
  double best_scatter = 0.0;  ///< under the exchange of axes that does best
  Mat3 best_axes = Mat3::Identity();
  double time_offset_s = 0.0;  ///< stamps + this = clock of the gyroscope, at the least scatter
  double scatter_at_offset = 0.0;
};

/// What the magnetometer's readings look like by themselves.
struct MagnetometerSurvey {
  StreamSummary stream;
  FieldUnit unit = FieldUnit::Tesla;      ///< in which the readings are plausible
  double field_T = 0.0;                   ///< median size, in that unit
  double field_spread = 0.0;              ///< standard deviation of the size, relative
  std::optional<double> inclination_rad;  ///< against the accelerometer; without calibration
  std::optional<FieldTurning> turning;    ///< where the rig turned enough
};

/// `imu`: of the same rig, in rad/s and m/s^2, in order of time.
MagnetometerSurvey surveyMagnetometer(MeasurementSource* source, const std::vector<ImuSample>& imu);

}  // namespace lodeline
