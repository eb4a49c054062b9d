#include "fuzzed_file.h"
#include "lodeline/magnetometer/calibration/magnetometer_record.h"

// Readings for a magnetometer calibration: tables, bare rows, compressed or not.

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lodeline;
  const fuzz::FuzzedFile file(data, size, ".csv");
  return fuzz::expectDocumentedErrors([&] {
    Diagnostics diagnostics;
    readMagnetometerRecord(file.path(), {}, &diagnostics);
  });
}
