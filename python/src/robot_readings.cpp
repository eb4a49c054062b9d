#include "python/src/robot_readings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace lodeline::python {
namespace {

std::optional<double> finite(double number) {
  return std::isfinite(number) ? std::optional(number) : std::nullopt;
}

/// An array (N, K), or (K) where N is 1, in C order; K is the number of beams.
struct BeamTable {
  Doubles array;
  size_t beams = 0;

  BeamTable(const Doubles& given, size_t count, const char* what) : array(given) {
    const auto wanted = static_cast<py::ssize_t>(count);
    const bool is_one = array.ndim() == 1 && count == 1;
    if (!is_one && (array.ndim() != 2 || array.shape(0) != wanted))
      throw py::value_error(fmt::format("{}: wanted shape ({}, K), one column for each beam", what, count));
    beams = static_cast<size_t>(array.shape(array.ndim() - 1));
  }
  std::optional<double> at(size_t ping, size_t beam) const {
    return finite(array.data()[ping * beams + beam]);
  }
};

std::optional<BeamTable> beamTable(const OptionalDoubles& given, size_t count, const char* what) {
  return given ? std::optional<BeamTable>(BeamTable(*given, count, what)) : std::nullopt;
}

/// Adds the beams to the pings, those without lock as well.
void addBeams(const std::optional<BeamTable>& velocities, const std::optional<BeamTable>& ranges,
              std::vector<DvlSample>* pings) {
  if (!velocities && !ranges) return;
  const size_t beams = velocities ? velocities->beams : ranges->beams;
  if (velocities && ranges && ranges->beams != beams)
    throw py::value_error("beam_velocity and beam_range: the same number of beams is wanted");
  for (size_t ping = 0; ping < pings->size(); ++ping) {
    for (size_t beam = 0; beam < beams; ++beam) {
      DvlBeam& made = (*pings)[ping].beams.emplace_back();
      made.index = static_cast<int>(beam);
      if (velocities) made.velocity_m_per_s = velocities->at(ping, beam);
      if (ranges) made.range_m = ranges->at(ping, beam);
    }
  }
}

/// Flags from a bool or an array of bool; false for None. Numbers are refused.
std::vector<bool> booleansFrom(py::handle given, size_t count) {
  if (given.is_none()) return std::vector<bool>(count, false);
  const auto found = py::array::ensure(given);
  if (!found || found.dtype().kind() != 'b') throw py::type_error("is_water_track: bool is wanted");
  const auto array = py::array_t<bool, py::array::c_style>::ensure(found);
  if (array.ndim() > 1 || static_cast<size_t>(array.size()) != count)
    throw py::value_error(fmt::format("is_water_track: wanted shape ({})", count));
  return std::vector<bool>(array.data(), array.data() + count);
}

}  // namespace

std::vector<DvlSample> pingsFrom(const std::vector<Time>& times, const OptionalDoubles& velocity,
                                 const OptionalDoubles& sigma, py::handle is_water_track,
                                 const OptionalDoubles& beam_velocity, const OptionalDoubles& beam_range) {
  const size_t count = times.size();
  if (!velocity && !beam_velocity && !beam_range)
    throw py::value_error("push_dvl: velocity, beam_velocity or beam_range is wanted");
  std::vector<Vec3> velocities;
  if (velocity) velocities = vectorsFrom(*velocity, count, "velocity");
  std::vector<double> sigmas;
  if (sigma) sigmas = numbersFrom(*sigma, count, "sigma");
  const std::vector<bool> is_water = booleansFrom(is_water_track, count);
  std::vector<DvlSample> pings(count);
  for (size_t i = 0; i < count; ++i) {
    DvlSample& ping = pings[i];
    ping.time = times[i];
    if (velocity && velocities[i].allFinite()) ping.velocity_D = velocities[i];
    if (sigma) ping.velocity_sigma_m_per_s = finite(sigmas[i]);
    if (is_water[i]) ping.track = DvlTrack::Water;
  }
  addBeams(beamTable(beam_velocity, count, "beam_velocity"), beamTable(beam_range, count, "beam_range"),
           &pings);
  return pings;
}

std::vector<CurrentSample> currentsFrom(const std::vector<Time>& times, const py::dict& currents,
                                        const std::vector<std::string>& channels) {
  for (const auto& [name, values] : currents) {
    const auto text = py::str(name).cast<std::string>();
    if (std::find(channels.begin(), channels.end(), text) == channels.end())
      throw UsageError(
          fmt::format("currents: the rig has no channel '{}', but {}", text, fmt::join(channels, ", ")));
  }
  std::vector<CurrentSample> samples(times.size());
  for (size_t i = 0; i < times.size(); ++i) samples[i].time = times[i];
  for (const std::string& channel : channels) {
    if (!currents.contains(channel)) throw UsageError(fmt::format("currents: '{}' is missing", channel));
    const auto array = Doubles::ensure(currents[py::str(channel)]);
    if (!array) {
      PyErr_Clear();
      throw py::type_error(fmt::format("currents['{}']: numbers are wanted", channel));
    }
    const std::vector<double> values = numbersFrom(array, times.size(), channel.c_str());
    for (size_t i = 0; i < times.size(); ++i) samples[i].currents_A.push_back(values[i]);
  }
  return samples;
}

}  // namespace lodeline::python
