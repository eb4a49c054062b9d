#include "fuzzed_file.h"
#include "lodeline/output/survey/profile/depth_profile.h"

// Depth profiles of dive computers: tables and logs in XML.

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lodeline;
  const fuzz::FuzzedFile file(data, size, ".csv");
  return fuzz::expectDocumentedErrors([&] {
    Diagnostics diagnostics;
    readDepthProfiles(file.path(), &diagnostics);
  });
}
