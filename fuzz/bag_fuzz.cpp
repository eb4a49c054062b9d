#include "fuzzed_file.h"
#include "lodeline/io/rosbag/bag_source.h"

// ROS 1 bags: records, chunks, and the messages of every sensor without images.

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lodeline;
  const fuzz::FuzzedFile file(data, size, ".bag");
  return fuzz::expectDocumentedErrors([&] {
    Diagnostics diagnostics;
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
