#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lodeline/io/robots/dvl_screen.h"
#include "lodeline/io/rosbag/definitions/message_fields.h"

/// Messages of the drivers of DVLs, in ROS 1's serialization and the forms of known_definitions.cpp.
namespace lodeline::messages {

inline constexpr Type kMarineDvl = {"marine_acoustic_msgs/Dvl", "f09bbfba6f467f84523073fb27d38e3e"};
inline constexpr Type kA50Dvl = {"waterlinked_a50_ros_driver/DVL", "dea1debc1aca7804a62c507714ec3777"};
inline constexpr Type kA50Dvl2 = {"dvl_msgs/DVL", "c82a2ba376dad0651b1400be6c9227aa"};
inline constexpr Type kSimulatedDvl = {"uuv_sensor_ros_plugins_msgs/DVL", "02bba6182b6f271447d7f88473256572"};
inline constexpr Type kColaDvl = {"cola2_msgs/DVL", "02bba6182b6f271447d7f88473256572"};
inline constexpr Type kTwist = {"geometry_msgs/TwistStamped", "98d34b0043a2093cf9d9345ab6eef12e"};
inline constexpr Type kTwistWithCovariance = {"geometry_msgs/TwistWithCovarianceStamped",
                                              "8927a1a12fb2607ceea095b2dc440a96"};

/// A ping and what its message states of the instrument.
struct DvlReading {
  StatedDvlPing ping;
  std::vector<Vec3> beams_D;  ///< unit vectors of the beams, by index; empty where the message has none
};
inline bool isFinite(const DvlReading&) { return true; }  // DvlScreen removes what is no number

/// Parses a message of one of the types above. A Twist is the velocity of the instrument.
DvlReading parseDvl(const std::string& type, std::span<const uint8_t> message);

/// Number of beams of a marine_acoustic_msgs/Dvl.
inline constexpr size_t kMarineBeams = 4;
/// A marine_acoustic_msgs/Dvl. It holds the first four beams, whose velocities have 32 bits.
wire::Bytes marineDvl(const DvlSample& sample, const std::vector<Vec3>& beams_D, uint32_t sequence);

/// The greatest angle between the beams of a message and those of a calibration, rad; nothing where the
/// message states none.
std::optional<double> beamDifference_rad(const std::vector<Vec3>& stated_D, const std::vector<Vec3>& beams_D);

}  // namespace lodeline::messages
