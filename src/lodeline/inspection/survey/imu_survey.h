#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/inspection/survey/stream_survey.h"
#include "lodeline/io/synchronizer/measurement_source.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// How the gyroscope fits the accelerometer: what gravity's direction does in the body frame,
/// dg/dt = -w x g, by its correlation with the gyroscope's rates under every exchange of axes.
struct GravityTurning {
  double correlation = 0.0;       ///< as recorded
  double best_correlation = 0.0;  ///< of the best exchange of axes
  Mat3 best_axes = Mat3::Identity();
  double scale = 0.0;  ///< of the gyroscope's rates, as recorded: 1 in rad/s
};

/// One of gyroscope and accelerometer.
struct TriadSurvey {
  std::array<bool, 3> is_dead = {false, false, false};  ///< axes that always say the same
  /// Readings at the end of the range: where more are there than shortly before it, as none can go beyond.
  double saturated_share = 0.0;
  double limit = 0.0;          ///< that end
  Vec3 spread = Vec3::Zero();  ///< standard deviation
};

/// What the inertial readings look like by themselves.
struct ImuSurvey {
  StreamSummary stream;
  /// In order of time, each stamp once, without what cannot be true; the accelerometer in m/s^2 whatever it
  /// was recorded in.
  std::vector<ImuSample> samples;
  Diagnostics screening;                 ///< what could not be true
  TriadSurvey gyroscope, accelerometer;  ///< in the units of the recording
  double median_force = 0.0;         ///< size of the accelerometer's readings, in the unit of the recording
  double force_to_SI = 1.0;          ///< 9.8 where they are in g
  double rest_s = 0.0;               ///< time at rest
  Vec3 rest_rate_B = Vec3::Zero();   ///< mean gyroscope at rest
  double rest_force_m_per_s2 = 0.0;  ///< mean size of the specific force at rest
  Vec3 up_B = Vec3::UnitZ();         ///< direction of the mean specific force
  std::optional<GravityTurning> turning;  ///< where the rig turned enough
};

/// Reports what the order of the stamps tells, as OrderedStream does.
ImuSurvey surveyImu(MeasurementSource* source, Diagnostics* diagnostics);

}  // namespace lodeline
