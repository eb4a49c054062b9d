#include "fuzzed_file.h"
#include "lodeline/magnetometer/calibration/calibration_file.h"

// The magnetometer's calibration file.

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lodeline;
  const fuzz::FuzzedFile file(data, size, ".yaml");
  return fuzz::expectDocumentedErrors([&] { readCalibrationFile(file.path()); });
}
