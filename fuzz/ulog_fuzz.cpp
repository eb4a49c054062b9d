#include "fuzzed_file.h"
#include "lodeline/io/logs/open_sensor_log.h"

// Logs of PX4. The first bytes make every input a ULog file, so that the fuzzer searches behind the header.

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lodeline;
  std::string bytes("ULog\x01\x12\x35\x01\0\0\0\0\0\0\0\0", 16);
  bytes.append(reinterpret_cast<const char*>(data), size);
  const fuzz::FuzzedFile file(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size(), ".ulg");
  return fuzz::expectDocumentedErrors([&] {
    Diagnostics diagnostics;
    const std::unique_ptr<SensorLog> log = openSensorLog(file.path(), {}, &diagnostics);
    LogReading reading;
    while (log->next(&reading)) {
    }
  });
}
