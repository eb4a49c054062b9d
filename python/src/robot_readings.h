#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/rig.h"
#include "python/src/arrays.h"

/// Readings of a vehicle's sensors from arrays. A shape that does not fit is a py::value_error.
namespace lodeline::python {

using OptionalDoubles = std::optional<Doubles>;

/// Pings of a DVL. NaN in the arrays means no lock; `is_water_track`: bool, array of bool or None. The
/// docstring of Odometry.push_dvl() has shapes and units.
std::vector<DvlSample> pingsFrom(const std::vector<Time>& times, const OptionalDoubles& velocity,
                                 const OptionalDoubles& sigma, py::handle is_water_track,
                                 const OptionalDoubles& beam_velocity, const OptionalDoubles& beam_range);

/// Readings of current sensors from arrays by the names of the channels. Throws UsageError where a name is
/// missing or unknown.
std::vector<CurrentSample> currentsFrom(const std::vector<Time>& times, const py::dict& currents,
                                        const std::vector<std::string>& channels);

}  // namespace lodeline::python
