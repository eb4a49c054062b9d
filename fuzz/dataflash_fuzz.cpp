#include "fuzzed_file.h"
#include "lodeline/io/logs/open_sensor_log.h"

// Logs of ArduPilot. The first bytes make every input a DataFlash log.

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lodeline;
  std::string bytes = "\xA3\x95\x80";
  bytes.append(reinterpret_cast<const char*>(data), size);
  const fuzz::FuzzedFile file(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size(), ".BIN");
  return fuzz::expectDocumentedErrors([&] {
    Diagnostics diagnostics;
    const std::unique_ptr<SensorLog> log = openSensorLog(file.path(), {}, &diagnostics);
    LogReading reading;
    while (log->next(&reading)) {
    }
  });
}
