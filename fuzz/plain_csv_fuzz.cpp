#include "fuzzed_file.h"
#include "lodeline/io/csv/plain_csv.h"

// A table of readings with named columns, as loggers and phones write it.

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lodeline;
  const fuzz::FuzzedFile file(data, size, ".csv");
  return fuzz::expectDocumentedErrors([&] {
    Diagnostics diagnostics;
    PlainCsv table(file.path(), &diagnostics);
    PlainReading reading;
    while (table.next(&reading)) {
    }
  });
}
