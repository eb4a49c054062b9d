#include <sstream>

#include "fuzzed_file.h"
#include "lodeline/io/rosbag/bag_kinds.h"
#include "lodeline/io/rosbag/bag_listing.h"
#include "lodeline/io/rosbag/bag_source.h"

// MCAP files: records, chunks, schemas, and the messages of every sensor without images.

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lodeline;
  const fuzz::FuzzedFile file(data, size, ".mcap");
  return fuzz::expectDocumentedErrors([&] {
    Diagnostics diagnostics;
    std::ostringstream list;
    listMessages(openBagFile(file.path(), &diagnostics).get(), 4, &list);
    BagOptions options;
    options.with_cameras = false;
    options.needs_calibration = false;
    BagSource bag(file.path(), options, &diagnostics);
    while (bag.nextImu()) {
    }
    while (bag.nextMagnetometer()) {
    }
    while (bag.nextDepth()) {
    }
    while (bag.nextSonar()) {
    }
    while (bag.nextAltimeter()) {
    }
    while (bag.nextDvl()) {
    }
    while (bag.nextCurrents()) {
    }
  });
}
