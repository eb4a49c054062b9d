#include "fuzzed_file.h"
#include "lodeline/mapping/control/files/control_set.h"

// Control points in tables, Survex' .3d and its .pos.

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lodeline;
  ControlReadOptions options;
  options.site = GeodeticPosition{20.5, -87.4, 8.0};
  options.grid_origin = Vec3(450000, 2267000, 6);
  for (const char* suffix : {".csv", ".3d", ".pos"}) {
    const fuzz::FuzzedFile file(data, size, suffix);
    fuzz::expectDocumentedErrors([&] {
      Diagnostics diagnostics;
      readControl(file.path(), options, &diagnostics);
    });
  }
  return 0;
}
