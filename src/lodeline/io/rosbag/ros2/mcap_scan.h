#pragma once

#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag/chunks/chunk_cache.h"
#include "lodeline/io/rosbag/container/bag_file.h"

namespace lodeline {

/// Reads the records of an MCAP file from the front and adds its chunks to `chunks`. Skips the contents of
/// chunks that message indexes follow, and scans the other chunks. A summary at the end is not needed. After
/// damaged bytes it continues at the next chunk that the summary names. Channels get numbers from
/// `first_channel` on. Reports what is missing as `bag_unindexed`, `bag_truncated`, `bag_damaged` and
/// `bag_chunk`. Throws InputError where the file is no MCAP file.
///
/// Messages outside of chunks are in parts of the file that are added as uncompressed chunks.
void scanMcap(uint32_t file, uint32_t first_channel, ChunkCache* chunks, BagContents* contents,
              Diagnostics* diagnostics);

}  // namespace lodeline
