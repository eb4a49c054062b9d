#pragma once

#include <optional>
#include <vector>

#include "lodeline/ahrs/field_unit.h"
#include "lodeline/inspection/survey/stream_survey.h"
#include "lodeline/recording.h"

namespace lodeline {

/// Consistency of magnetometer and gyroscope: after compensation of the rotation by the gyroscope, the field
/// must be constant.
struct FieldTurning {
  double scatter = 0.0;       ///< of the compensated field, relative to its norm, with the axes as recorded
  double best_scatter = 0.0;  ///< with the best permutation of axes
  Mat3 best_axes = Mat3::Identity();
  double time_offset_s = 0.0;  ///< time stamps + this = clock of the gyroscope, at the smallest scatter
  double scatter_at_offset = 0.0;
};

/// Properties of the magnetometer's readings.
struct MagnetometerSurvey {
  StreamSummary stream;
  FieldUnit unit = FieldUnit::Tesla;      ///< in which the readings are plausible
  double field_T = 0.0;                   ///< median norm, in that unit
  double field_spread = 0.0;              ///< standard deviation of the norm, relative
  std::optional<double> inclination_rad;  ///< relative to the accelerometer; without calibration
  std::optional<FieldTurning> turning;    ///< where the rig rotated enough
};

/// `imu`: of the same rig, in rad/s and m/s^2, in order of time.
MagnetometerSurvey surveyMagnetometer(MeasurementSource* source, const std::vector<ImuSample>& imu);

}  // namespace lodeline
