#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/inspection/survey/stream_survey.h"
#include "lodeline/recording.h"

namespace lodeline {

/// Consistency of gyroscope and accelerometer: correlation of the change of gravity's direction in the body
/// frame, dg/dt = -w x g, with the gyroscope's rates, for every permutation of axes.
struct GravityTurning {
  double correlation = 0.0;       ///< as recorded
  double best_correlation = 0.0;  ///< with the best permutation of axes
  Mat3 best_axes = Mat3::Identity();
  double scale = 0.0;  ///< of the gyroscope's rates, as recorded: 1 in rad/s
};

/// Survey of the gyroscope or the accelerometer.
struct TriadSurvey {
  std::array<bool, 3> is_dead = {false, false, false};  ///< axes with constant readings
  /// Share of readings at the end of the range. The end is recognized by more readings there than shortly
  /// before it.
  double saturated_share = 0.0;
  double limit = 0.0;          ///< end of the range
  Vec3 spread = Vec3::Zero();  ///< standard deviation
};

/// Properties of the inertial readings.
struct ImuSurvey {
  StreamSummary stream;
  /// In order of time, each stamp once, without impossible readings; the accelerometer in m/s^2 whatever its
  /// recorded unit.
  std::vector<ImuSample> samples;
  Diagnostics screening;                 ///< the impossible readings
  TriadSurvey gyroscope, accelerometer;  ///< in the units of the recording
  double median_force = 0.0;         ///< norm of the accelerometer's readings, in the unit of the recording
  double force_to_SI = 1.0;          ///< 9.8 where they are in g
  double rest_s = 0.0;               ///< time at rest
  Vec3 rest_rate_B = Vec3::Zero();   ///< mean gyroscope at rest
  double rest_force_m_per_s2 = 0.0;  ///< mean size of the specific force at rest
  Vec3 up_B = Vec3::UnitZ();         ///< direction of the mean specific force
  std::optional<GravityTurning> turning;  ///< where the rig rotated enough
  /// Mean difference of every other accelerometer reading from those between, m/s^2, where it is the same in
  /// nearly all seconds: readings of two sensors by turns. Otherwise 0.
  double alternation_m_per_s2 = 0.0;
};

/// Reports errors in the order of the time stamps, as OrderedStream does.
ImuSurvey surveyImu(MeasurementSource* source, Diagnostics* diagnostics);

}  // namespace lodeline
