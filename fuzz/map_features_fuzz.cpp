#include "fuzzed_file.h"
#include "lodeline/mapping/store/pack/feature_block.h"

// Features of a keyframe in a map file. What is read must be packed again and read as often as before.

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lodeline;
  return fuzz::expectDocumentedErrors([&] {
    const std::vector<MapFeature> features = unpackFeatures({data, size});
    if (unpackFeatures(packFeatures(features)).size() != features.size()) std::abort();
  });
}
