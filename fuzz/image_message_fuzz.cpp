#include "fuzzed_file.h"
#include "lodeline/io/images/image_loader.h"
#include "lodeline/io/rosbag/image_messages.h"

// Image messages; the first byte selects the kind.

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace lodeline;
  if (size == 0) return 0;
  const std::span<const uint8_t> message(data + 1, size - 1);
  if (data[0] & 1) {
    const StoredImage image = messages::imagePixels(message, "fuzz");
    if (!image.pixels.empty()) greyFrom(image.pixels);
  } else {
    messages::compressedImageFile(message, "fuzz");
  }
  return 0;
}
