#include "fuzzed_file.h"
#include "lodeline/io/images/grey_png.h"

// The decoder of grey PNG images. Headers of images larger than 64 megapixels are skipped: no camera writes
// them, and filling such images takes the fuzzer's time.

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  constexpr size_t kEndOfSize = 24;
  if (size >= kEndOfSize &&
      (data[16] | data[17] | (data[18] & 0xE0) | data[20] | data[21] | (data[22] & 0xE0)) != 0)
    return 0;
  lodeline::decodeGreyPng({data, size});
  return 0;
}
