#pragma once

#include <optional>
#include <span>
#include <string>

#include "lodeline/io/streams/reading_history.h"

namespace lodeline {

/// Factors that convert later readings of a stream to the unit and sign of the earlier ones.
struct ReadingFactors {
  Vec3 rate = Vec3::Ones();   ///< per axis
  Vec3 force = Vec3::Ones();  ///< per axis
  std::string words;          ///< description of the change: "the accelerometer's readings are now in g"

  ImuSample apply(ImuSample sample) const {
    sample.angular_velocity_B = sample.angular_velocity_B.cwiseProduct(rate);
    sample.specific_force_B = sample.specific_force_B.cwiseProduct(force);
    return sample;
  }
};

/// Number of readings that suffice to identify a change of unit.
inline constexpr size_t kUnitReadings = 40;

/// The change of unit (rad/s and deg/s; m/s^2, g and mg) or of one axis' sign between `before` and
/// `following`. It must explain both a jump between the two and the magnitude of the changes within each.
/// Returns nothing otherwise.
std::optional<ReadingFactors> changeOfUnit(const ReadingHistory& before,
                                           std::span<const ImuSample> following);

/// Factor from an accelerometer's first readings (in g or mg) to m/s^2, determined from the magnitude of
/// gravity. Returns 1 where they are in m/s^2 or fit no unit.
double forceToSI(std::span<const ImuSample> samples);

}  // namespace lodeline
