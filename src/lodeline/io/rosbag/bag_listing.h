#pragma once

#include <ostream>
#include <string>

#include "lodeline/io/rosbag/container/bag_file.h"

namespace lodeline {

/// A line for each topic: name, type, number of messages, and what Lodeline can do with it.
std::string topicsText(const BagFile& bag);

/// Writes a line for each message in the order of recording: time in nanoseconds, topic, type, and all fields
/// as their definition in the bag describes them. Arrays are cut after `most_elements`.
void listMessages(BagFile* bag, size_t most_elements, std::ostream* stream);

}  // namespace lodeline
