#pragma once

#include <span>
#include <string>

#include "lodeline/io/rosbag/chunks/wire.h"

namespace lodeline {

/// Unpacked messages of a chunk, possibly incomplete.
struct Unpacked {
  wire::Bytes bytes;
  std::string problem;  ///< reason why `bytes` are incomplete; empty where they are complete
};

/// Unpacks a chunk of a bag. `compression`: "none" or "", "bz2", "lz4" (LZ4's frame format) or "zstd".
/// `size`: number of unpacked bytes stated in the chunk. Of damaged or truncated data, the part before the
/// damage is returned.
Unpacked unpackChunk(const std::string& compression, std::span<const uint8_t> packed, size_t size);

}  // namespace lodeline
