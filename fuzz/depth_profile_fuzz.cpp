#include "fuzzed_file.h"
#include "lodeline/io/dives/depth_profile.h"

// Depth profiles of dive computers: tables, XML, DL7 and archives of them.

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lodeline;
  const fuzz::FuzzedFile file(data, size, ".csv");
  return fuzz::expectDocumentedErrors([&] {
    Diagnostics diagnostics;
    readDepthProfiles(file.path(), &diagnostics);
  });
}
