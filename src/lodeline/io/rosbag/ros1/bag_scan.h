#pragma once

#include "lodeline/diagnostics.h"
#include "lodeline/io/rosbag/chunks/chunk_cache.h"
#include "lodeline/io/rosbag/container/bag_file.h"

namespace lodeline {

/// Reads the records of a bag from the front and adds its chunks to `chunks`. Skips the contents of chunks
/// that are followed by an index record and scans the other chunks. After damaged bytes it continues at the
/// next recognizable chunk. Reports findings like BagFile. Throws InputError where the file is not a bag of
/// format 2.0 or is encrypted.
BagContents scanBag(ChunkCache* chunks, Diagnostics* diagnostics);

}  // namespace lodeline
