#pragma once

#include <span>
#include <string>
#include <vector>

#include "lodeline/io/rosbag/definitions/message_fields.h"
#include "lodeline/rig.h"

/// Messages with electric currents, in ROS 1's serialization.
namespace lodeline::messages {

inline constexpr Type kBatteryState = {"sensor_msgs/BatteryState", "4ddae7f048e32fda22cac764685e3974"};
inline constexpr Type kJointState = {"sensor_msgs/JointState", "3066dcd76a6cfaef579bd0f34173e9fd"};

/// Currents with the names of their channels.
struct NamedCurrents {
  Time time;
  std::vector<std::string> names;
  std::vector<double> currents_A;
};
bool isFinite(const NamedCurrents& currents);

/// Parses a JointState, whose efforts are currents (A), or a BatteryState, whose location is the name of its
/// channel.
NamedCurrents parseCurrents(const std::string& type, std::span<const uint8_t> message);
/// Names for a rig without channels; a battery without a location becomes `battery`.
std::vector<std::string> channelNames(const NamedCurrents& currents);
/// Currents in the order of the channels of a calibration; see channelOrder(). A battery without a location
/// is the only channel of the calibration.
CurrentSample inOrder(const std::string& where, const NamedCurrents& currents,
                      const std::vector<std::string>& channels);
/// A JointState with the names of the channels and their currents as efforts.
wire::Bytes jointCurrents(const CurrentSample& sample, const std::vector<std::string>& channels,
                          uint32_t sequence);

}  // namespace lodeline::messages
