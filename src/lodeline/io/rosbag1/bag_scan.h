#pragma once

#include <map>
#include <string>
#include <vector>

#include "lodeline/io/rosbag1/chunk_cache.h"
#include "lodeline/util/diagnostics.h"
#include "lodeline/util/time/time.h"

namespace lodeline {

/// Where a message lies.
struct BagEntry {
  Time received;
  uint32_t chunk = 0;   ///< number of the chunk in the file
  uint32_t offset = 0;  ///< of the message's record among the chunk's unpacked bytes
};

/// One publisher of messages.
struct BagConnection {
  std::string topic;
  std::string type;    ///< e.g. "sensor_msgs/Imu"
  std::string md5sum;  ///< of the type's definition
};

/// What a bag holds, by the number of the connection.
struct BagContents {
  std::map<uint32_t, BagConnection> connections;
  std::map<uint32_t, std::vector<BagEntry>> entries;  ///< in the order of the file
};

/// Walks through the records of a bag from the front, passing over the contents of chunks that have an index
/// record behind them and looking through the others, and enters the chunks in `chunks`. Past damaged bytes
/// it goes on at the next chunk that can be recognized. Reports as BagFile says. Throws InputError where the
/// file is no bag of format 2.0 or is encrypted.
BagContents scanBag(ChunkCache* chunks, Diagnostics* diagnostics);

}  // namespace lodeline
