#pragma once

#include <span>

#include "lodeline/io/streams/reading_history.h"

namespace lodeline {

/// Whether a reading changes so much against the previous ones that the following ones must be examined.
bool isJump(const ReadingHistory& before, const ImuSample& sample);

/// Number of spikes at the front of `following`, 0 for none. Spikes are one or two readings that leave the
/// course of the readings before them, to which the later readings return. Their change exceeds twelve times
/// the median change on both sides. A mechanical shock is not a spike, because a sensor's low-pass filter
/// spreads it over several readings, and it oscillates. `following` should have kSpikeReadings readings,
/// fewer at the end of a stream.
size_t spikesAtFront(const ReadingHistory& before, std::span<const ImuSample> following);

inline constexpr size_t kSpikeReadings = 10;

}  // namespace lodeline
