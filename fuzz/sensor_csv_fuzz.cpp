#include "fuzzed_file.h"
#include "lodeline/io/euroc/csv_reader.h"
#include "lodeline/io/euroc/current_table.h"
#include "lodeline/io/euroc/dvl_table.h"

// Rows of a sensor in the EuRoC ASL layout: readings (imu0, dvl0, current0) and lists of images (cam0).

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lodeline;
  const fuzz::FuzzedFile file(data, size, ".csv");
  for (const CsvContent content : {CsvContent::Imu, CsvContent::Images}) {
    fuzz::expectDocumentedErrors([&] {
      Diagnostics diagnostics;
      CsvReader reader(file.path(), content, &diagnostics,
                       content == CsvContent::Imu ? kInertialRate : kCameraRate);
      CsvRow row;
      while (reader.next(&row)) {
      }
    });
  }
  fuzz::expectDocumentedErrors([&] {
    Diagnostics diagnostics;
    DvlTable table(file.path(), 4, &diagnostics);
    while (table.next()) {
    }
  });
  fuzz::expectDocumentedErrors([&] {
    Diagnostics diagnostics;
    CurrentTable table(file.path(), {}, &diagnostics);
    while (table.next()) {
    }
  });
  return 0;
}
