#include "lodeline/io/rosbag/robots/current_messages.h"

#include <algorithm>
#include <cmath>

#include "lodeline/diagnostics.h"
#include "lodeline/io/robots/channel_order.h"

namespace lodeline::messages {
namespace {

/// Whether the names are that of a battery without a location.
bool isUnnamed(const std::vector<std::string>& names) { return names.size() == 1 && names.front().empty(); }

NamedCurrents parseJoints(wire::Reader* reader) {
  NamedCurrents currents;
  currents.time = takeHeader(reader);
  const auto names = reader->take<uint32_t>();
  for (uint32_t i = 0; i < names; ++i) currents.names.emplace_back(reader->takeText());
  for (int skipped = 0; skipped < 2; ++skipped) {  // positions, velocities
    const auto count = reader->take<uint32_t>();
    reader->takeBytes(size_t{count} * sizeof(double));
  }
  const auto efforts = reader->take<uint32_t>();
  for (uint32_t i = 0; i < efforts; ++i) currents.currents_A.push_back(reader->take<double>());
  return currents;
}

NamedCurrents parseBattery(wire::Reader* reader) {
  NamedCurrents currents;
  currents.time = takeHeader(reader);
  reader->takeBytes(2 * sizeof(float));  // voltage, temperature
  currents.currents_A.push_back(decimal(reader->take<float>()));
  reader->takeBytes(4 * sizeof(float) + 4);        // charges, percentage; states, presence
  for (int skipped = 0; skipped < 2; ++skipped) {  // voltages and temperatures of the cells
    const auto count = reader->take<uint32_t>();
    reader->takeBytes(size_t{count} * sizeof(float));
  }
  currents.names.emplace_back(reader->takeText());
  return currents;
}

}  // namespace

bool isFinite(const NamedCurrents& currents) {
  return std::all_of(currents.currents_A.begin(), currents.currents_A.end(),
                     [](double current) { return std::isfinite(current); });
}

NamedCurrents parseCurrents(const std::string& type, std::span<const uint8_t> message) {
  wire::Reader reader(message);
  return type == kJointState.name ? parseJoints(&reader) : parseBattery(&reader);
}

std::vector<std::string> channelNames(const NamedCurrents& currents) {
  return isUnnamed(currents.names) ? std::vector<std::string>{"battery"} : currents.names;
}

CurrentSample inOrder(const std::string& where, const NamedCurrents& currents,
                      const std::vector<std::string>& channels) {
  if (currents.names.size() != currents.currents_A.size()) {
    throw InputError(where + ": has not as many currents (efforts) as names");
  }
  CurrentSample sample;
  sample.time = currents.time;
  if (isUnnamed(currents.names) && channels.size() <= 1) {
    sample.currents_A = currents.currents_A;
    return sample;
  }
  for (const size_t place : channelOrder(where, currents.names, channels))
    sample.currents_A.push_back(currents.currents_A[place]);
  return sample;
}

wire::Bytes jointCurrents(const CurrentSample& sample, const std::vector<std::string>& channels,
                          uint32_t sequence) {
  wire::Writer writer;
  putHeader(sample.time, sequence, "current0", &writer);
  writer.put(static_cast<uint32_t>(channels.size()));
  for (const std::string& channel : channels) writer.putText(channel);
  writer.put(uint32_t{0});  // no positions
  writer.put(uint32_t{0});  // no velocities
  writer.put(static_cast<uint32_t>(sample.currents_A.size()));
  for (const double current_A : sample.currents_A) writer.put(current_A);
  return writer.take();
}

}  // namespace lodeline::messages
