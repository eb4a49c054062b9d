#pragma once

#include <span>

#include "lodeline/io/streams/reading_history.h"

namespace lodeline {

/// Whether a reading changes so suddenly against those just before that those after must be looked at.
bool isJump(const ReadingHistory& before, const ImuSample& sample);

/// Number of readings at the front of `following` that are spikes: one or two that leave the course of the
/// readings before them, to which the readings after return, by more than twelve times the median change on
/// both sides. 0 for none. A knock is no spike: a sensor's low-pass filter spreads it over several readings,
/// and it rings. `following` should hold kSpikeReadings readings, fewer at the end of a stream.
size_t spikesAtFront(const ReadingHistory& before, std::span<const ImuSample> following);

inline constexpr size_t kSpikeReadings = 10;

}  // namespace lodeline
