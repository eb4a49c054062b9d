#pragma once

#include <cstdint>
#include <functional>
#include <string_view>

#include "simulation/shared/motion.h"

namespace lodeline {

using TimeFunction = std::function<double(double)>;

/// Options of the rig's motion relative to the diver's path.
struct HandMotionOptions {
  uint64_t seed = 1;
  double duration_s = 0.0;
  double liveliness = 1.0;
  TimeFunction activity;  ///< 0 at rest, 1 held in the hands
  TimeFunction kick;      ///< strength of fin kicks, 0 to 1
  bool sweeps = true;     ///< turns of the rig to one side every ten to thirty seconds
};

/// Adds fin kicks, breathing, swaying, sweeps and tremor to the channels. Values: kick cycle 0.45 to 0.65 Hz
/// with 6 mm of surge at its double (two kicks per cycle); breathing at 0.16 to 0.22 Hz with 2.5 cm of rise;
/// swaying of 2 to 4 degrees over seconds; sweeps of 10 to 30 degrees; tremor of 0.1 degrees and 0.4 mm below
/// 3 Hz (a housing of several kilograms in water damps higher frequencies).
void addHandMotion(const HandMotionOptions& options, MotionChannels& channels);

/// A spline over the whole range in which a motion of `duration_s` is defined.
Spline motionSpline(double duration_s, double spacing_s, const TimeFunction& control);

/// Noise up to about 0.3 / spacing Hz under an envelope, from independent normal control points of the given
/// sigma. A quintic spline keeps 0.65 of their standard deviation.
MotionChannel::Enveloped motionNoise(uint64_t seed, std::string_view stream, double duration_s,
                                     const TimeFunction& envelope, double spacing_s, double control_sigma);

}  // namespace lodeline
