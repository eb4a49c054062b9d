#include "fuzzed_file.h"
#include "lodeline/data/euroc_calibration.h"
#include "lodeline/data/kalibr_calibration.h"
#include "lodeline/data/rig_file.h"

// Calibrations of cameras and sensors: EuRoC's sensor.yaml, Kalibr's results, rig files.

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lodeline;
  const fuzz::FuzzedFile file(data, size, ".yaml");
  Diagnostics diagnostics;
  const auto attempt = [](const auto& read) { fuzz::expectDocumentedErrors(read); };
  attempt([&] { readEurocImu(file.path(), &diagnostics); });
  attempt([&] { readEurocCamera(file.path(), "cam0", &diagnostics); });
  attempt([&] { readEurocMagnetometer(file.path(), &diagnostics); });
  attempt([&] { readEurocPressure(file.path(), &diagnostics); });
  attempt([&] { readEurocSonar(file.path(), &diagnostics); });
  attempt([&] { readKalibrCameras(file.path(), &diagnostics); });
  attempt([&] { readKalibrImu(file.path(), &diagnostics); });
  attempt([&] { readRigFiles({file.path()}, &diagnostics); });
  return 0;
}
