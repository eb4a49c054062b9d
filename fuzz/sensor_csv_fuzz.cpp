#include "fuzzed_file.h"
#include "lodeline/data/csv_reader.h"

// Rows of a sensor in the EuRoC ASL layout: readings (imu0) and lists of images (cam0).

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lodeline;
  const fuzz::FuzzedFile file(data, size, ".csv");
  for (const int numbers : {6, 0}) {
    fuzz::expectDocumentedErrors([&] {
      Diagnostics diagnostics;
      CsvReader reader(file.path(), numbers, &diagnostics);
      CsvRow row;
      while (reader.next(&row)) {
      }
    });
  }
  return 0;
}
