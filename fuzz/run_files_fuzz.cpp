#include "fuzzed_file.h"
#include "lodeline/output/files/landmark_file.h"
#include "lodeline/output/files/run_table.h"

// Files of a results folder, possibly truncated or damaged: states.csv and landmarks.ply.

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lodeline;
  const fuzz::FuzzedFile file(data, size, ".csv");
  Diagnostics diagnostics;
  fuzz::expectDocumentedErrors([&] { readRunTable(file.path(), &diagnostics); });
  fuzz::expectDocumentedErrors([&] { readLandmarkFile(file.path(), &diagnostics); });
  return 0;
}
