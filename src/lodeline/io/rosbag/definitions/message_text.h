#pragma once

#include <span>
#include <string>

#include "lodeline/io/rosbag/definitions/type_description.h"

namespace lodeline::definitions {

/// All fields of a message on one line, as "{header: {stamp: {sec: 1, nanosec: 5}, frame_id: "a"}, data: [1,
/// 2]}". Long arrays are cut after `most_elements` with their number of elements. Bytes that the definition
/// does not describe are stated after it. Throws wire::Reader::CutOff and DefinitionError as FieldReader
/// does.
std::string messageText(std::span<const uint8_t> message, const TypeDescription& type,
                        Serialization serialization, size_t most_elements);

}  // namespace lodeline::definitions
