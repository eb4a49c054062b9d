#pragma once

#include <string>
#include <string_view>

#include "lodeline/io/rosbag/definitions/type_description.h"

namespace lodeline::definitions {

/// "sensor_msgs/Imu" for "sensor_msgs/msg/Imu"; service types keep their middle part.
std::string shortTypeName(std::string_view type);

/// Parses a definition in the text form of .msg files. The types of its fields follow it, each after a line
/// of equal signs and a line "MSG: NAME". Types that do not follow are taken from knownDefinition(). The text
/// of a service describes its events, requests and responses. Throws DefinitionError for damaged definitions.
/// `serialization`: that of the messages, which decides how a header is laid out.
TypeDescription parseDefinition(const std::string& type, std::string_view text, Serialization serialization);

}  // namespace lodeline::definitions
