#include "fuzzed_file.h"
#include "lodeline/io/calibration/rig_file.h"

// Calibrations of every known program, identified by their content: rig files, Kalibr, OpenVINS, VINS,
// ORB-SLAM3, OKVIS, Basalt, camera_info.

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lodeline;
  const fuzz::FuzzedFile file(data, size, ".yaml");
  return fuzz::expectDocumentedErrors([&] {
    Diagnostics diagnostics;
    readRigFiles({file.path()}, &diagnostics);
  });
}
