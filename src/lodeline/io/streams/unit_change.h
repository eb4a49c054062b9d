#pragma once

#include <optional>
#include <span>
#include <string>

#include "lodeline/io/streams/reading_history.h"

namespace lodeline {

/// What a stream of readings must be multiplied with, from some reading on, to go on as before.
struct ReadingFactors {
  Vec3 rate = Vec3::Ones();   ///< axis by axis
  Vec3 force = Vec3::Ones();  ///< likewise
  std::string words;          ///< what happened: "the accelerometer's readings are now in g"

  ImuSample apply(ImuSample sample) const {
    sample.angular_velocity_B = sample.angular_velocity_B.cwiseProduct(rate);
    sample.specific_force_B = sample.specific_force_B.cwiseProduct(force);
    return sample;
  }
};

/// Readings that kUnitReadings are enough of to tell a change of the unit.
inline constexpr size_t kUnitReadings = 40;

/// The change of unit (rad/s and deg/s; m/s^2, g and mg) or of one axis' sign between `before` and
/// `following`, where one explains a jump between the two and the size of the changes within both; nothing
/// else does both.
std::optional<ReadingFactors> changeOfUnit(const ReadingHistory& before,
                                           std::span<const ImuSample> following);

/// The factor that takes an accelerometer's first readings to m/s^2, by gravity's size: those in g or mg. 1
/// where they are in m/s^2 or fit nothing.
double forceToSI(std::span<const ImuSample> samples);

}  // namespace lodeline
