#pragma once

#include <map>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag1/chunk_cache.h"
#include "lodeline/types.h"

namespace lodeline {

/// Position of a message in the bag.
struct BagEntry {
  Time received;
  uint32_t chunk = 0;   ///< number of the chunk in the file
  uint32_t offset = 0;  ///< position of the message's record in the unpacked bytes of the chunk
};

/// One publisher of messages.
struct BagConnection {
  std::string topic;
  std::string type;    ///< e.g. "sensor_msgs/Imu"
  std::string md5sum;  ///< checksum of the type's definition
};

/// Connections and messages of a bag, by the number of the connection.
struct BagContents {
  std::map<uint32_t, BagConnection> connections;
  std::map<uint32_t, std::vector<BagEntry>> entries;  ///< in the order in the file
};

/// Reads the records of a bag from the front and adds its chunks to `chunks`. Skips the contents of chunks
/// that are followed by an index record and scans the other chunks. After damaged bytes it continues at the
/// next recognizable chunk. Reports findings like BagFile. Throws InputError where the file is not a bag of
/// format 2.0 or is encrypted.
BagContents scanBag(ChunkCache* chunks, Diagnostics* diagnostics);

}  // namespace lodeline
