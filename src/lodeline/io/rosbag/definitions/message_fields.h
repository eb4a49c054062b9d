#pragma once

#include <string_view>

#include "lodeline/io/rosbag/chunks/wire.h"
#include "lodeline/types.h"

/// Parts that several messages share, in ROS 1's serialization.
namespace lodeline::messages {

/// Name of a message type and the checksum of its definition, which changes when the definition does.
struct Type {
  const char* name;
  const char* md5sum;
};

/// The stamp of a header, which is passed over.
Time takeHeader(wire::Reader* reader);
void putHeader(Time stamp, uint32_t sequence, std::string_view frame, wire::Writer* writer);
Vec3 takeVector(wire::Reader* reader);
void putVector(const Vec3& vector, wire::Writer* writer);
Rigid3 takePose(wire::Reader* reader);
/// The shortest decimal number that identifies a float: 3.1 where 32 bits store 3.0999999.
double decimal(float value);

}  // namespace lodeline::messages
