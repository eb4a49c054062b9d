#pragma once

#include <optional>
#include <vector>

#include "lodeline/magnetometer/field_map/field_map.h"
#include "lodeline/mapping/session/loops/known_keyframes.h"

namespace lodeline {

/// Compares the magnetic fields along both ways of a loop. docs/theory/loop-verification.md has the model.
struct FieldSupportOptions {
  FieldMapOptions map;                ///< length scale and size of anomalies
  double reach_m = 5.0;               ///< path before and after a keyframe on which readings count
  int least_readings = 3;             ///< of the new way within a length scale of readings of the old way
  double least_variation_T = 0.6e-6;  ///< along the ways, per axis; below, the field says nothing
  double floor_T = 0.2e-6;            ///< error that the model of the anomaly leaves, per axis
  double offset_sigma_T = 0.15e-6;    ///< hard iron that is not estimated, the same in all readings of a dive
  double axes_sigma = 0.003;  ///< errors of the axes, relative and rad, the same in all readings of a dive
  /// The same where the ways belong to two dives, whose sensors and iron differ.
  double other_offset_sigma_T = 5e-6, other_axes_sigma = 0.02;
  double earth_sigma_T = 60e-6;       ///< of the Earth's field, the same in all readings
  double most_turn_rad = 1.05;        ///< 60 degrees; beyond, errors of the calibration may contradict a loop
  double least_log_ratio = -4.6;      ///< a loop below is contradicted: 1 to 100
  double supporting_log_ratio = 3.0;  ///< a loop above is supported: 20 to 1
  int supporting_values = 24;         ///< that this takes at least
  double contradiction_probability = 0.9999;  ///< that chi-squared of a true loop is smaller
};

/// The agreement of the fields, given the pose of a loop. Empty where the field says nothing: few readings,
/// ways that do not meet within the reach, or a field that does not vary. That is so in limestone.
std::optional<FieldAgreement> fieldSupport(const KnownKeyframes& known, const Loop& loop,
                                           const FieldSupportOptions& options = {});

/// Whether the field can tell the place of the old keyframe from others: it varies along the old way, and the
/// new keyframe has a reading.
bool isFieldTelling(const KnownKeyframes& known, const Loop& loop, const FieldSupportOptions& options = {});

/// Whether the field supports most of the loops for which it has enough readings. Few readings support any
/// place, because fields are smooth.
bool areSupportedByField(const std::vector<Loop>& loops, const FieldSupportOptions& options = {});

/// Sets Loop::field. A verified loop that the field contradicts becomes Refused, with the reason.
void judgeByField(const KnownKeyframes& known, Loop* loop, const FieldSupportOptions& options = {});

}  // namespace lodeline
