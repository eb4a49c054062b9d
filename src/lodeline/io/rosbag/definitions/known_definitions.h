#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "lodeline/io/rosbag/definitions/type_description.h"

namespace lodeline::definitions {

/// The fields of a common type, one per line, for bags that do not contain their definitions. Nothing where
/// the type is unknown. ROS 1 and ROS 2 differ in some types.
std::optional<std::string_view> knownFields(std::string_view type, Serialization serialization);

/// Checksum of a type in ROS 1 that Lodeline reads; empty for other types.
std::string_view ros1Checksum(std::string_view type);

/// Whether definitions of other versions of a known type are in use: messages are then read by the definition
/// in the bag, and fields that it does not have are 0.
bool hasVersions(std::string_view type);

/// A complete definition with the types of all fields, as bags contain it. Throws std::logic_error for an
/// unknown type.
std::string fullDefinition(const std::string& type, Serialization serialization);

}  // namespace lodeline::definitions
