#include "fuzzed_file.h"
#include "lodeline/trajectory.h"

// COLMAP's images.bin and images.txt.

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lodeline;
  for (const TrajectoryFormat format : {TrajectoryFormat::ColmapBinary, TrajectoryFormat::ColmapText}) {
    const fuzz::FuzzedFile file(data, size, format == TrajectoryFormat::ColmapBinary ? ".bin" : ".txt");
    fuzz::expectDocumentedErrors([&] {
      Diagnostics diagnostics;
      TrajectoryReadOptions options;
      options.format = format;
      readTrajectory(file.path(), options, diagnostics);
    });
  }
  return 0;
}
