#include "fuzzed_file.h"
#include "lodeline/trajectory.h"

// Trajectories in every layout; the layout is recognized from the file.

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lodeline;
  const fuzz::FuzzedFile file(data, size, ".txt");
  return fuzz::expectDocumentedErrors([&] {
    Diagnostics diagnostics;
    readTrajectory(file.path(), {}, diagnostics);
  });
}
