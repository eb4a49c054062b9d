#pragma once

#include <span>
#include <string>

#include "lodeline/io/rosbag1/wire.h"

namespace lodeline {

/// A chunk's messages, as far as they could be unpacked.
struct Unpacked {
  wire::Bytes bytes;
  std::string problem;  ///< why `bytes` are not all; empty where they are
};

/// Unpacks a chunk of a bag. `compression`: "none", "bz2" or "lz4" (LZ4's frame format). `size`: of the
/// unpacked bytes, as the chunk says. Of damaged or cut-off data what comes before the damage is returned.
Unpacked unpackChunk(const std::string& compression, std::span<const uint8_t> packed, size_t size);

}  // namespace lodeline
