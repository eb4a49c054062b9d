#include "lodeline/io/images/grey_png.h"

#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string_view>
#include <vector>

#include "lodeline/io/images/png_filters.h"

namespace lodeline {
namespace {

constexpr std::array<uint8_t, 8> kSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
constexpr size_t kHeaderBytes = 13;
/// Maximum compression ratio of Deflate, 1032 to 1; a header with a larger ratio is damaged.
constexpr size_t kGreatestRatio = 1032;

uint32_t bigEndian(const uint8_t* bytes) {
  return uint32_t{bytes[0]} << 24 | uint32_t{bytes[1]} << 16 | uint32_t{bytes[2]} << 8 | uint32_t{bytes[3]};
}

struct Chunk {
  std::string_view type;
  std::span<const uint8_t> data;
};

/// Takes the chunk at the front of `rest`; returns false where it is truncated or its checksum is wrong.
bool takeChunk(std::span<const uint8_t>* rest, Chunk* chunk) {
  constexpr size_t kFrameBytes = 12;
  if (rest->size() < kFrameBytes) return false;
  const size_t size = bigEndian(rest->data());
  if (rest->size() - kFrameBytes < size) return false;
  const uint8_t* type = rest->data() + 4;
  chunk->type = std::string_view(reinterpret_cast<const char*>(type), 4);
  chunk->data = rest->subspan(8, size);
  if (libdeflate_crc32(0, type, 4 + size) != bigEndian(type + 4 + size)) return false;
  *rest = rest->subspan(kFrameBytes + size);
  return true;
}

struct GreyPng {
  int width_px = 0;
  int height_px = 0;
  std::vector<uint8_t> compressed;
};

bool readHeader(const Chunk& chunk, GreyPng* png) {
  if (chunk.type != "IHDR" || chunk.data.size() != kHeaderBytes) return false;
  // Bit depth 8, colour type grey, the one compression and filter method, not interlaced.
  constexpr std::array<uint8_t, 5> kPlainGrey = {8, 0, 0, 0, 0};
  if (!std::equal(kPlainGrey.begin(), kPlainGrey.end(), chunk.data.begin() + 8)) return false;
  const uint32_t width = bigEndian(chunk.data.data());
  const uint32_t height = bigEndian(chunk.data.data() + 4);
  constexpr uint32_t kGreatestSide = 1 << 15;
  if (width == 0 || height == 0 || width > kGreatestSide || height > kGreatestSide) return false;
  png->width_px = static_cast<int>(width);
  png->height_px = static_cast<int>(height);
  return true;
}

bool readChunks(std::span<const uint8_t> bytes, GreyPng* png) {
  if (bytes.size() < kSignature.size() || !std::equal(kSignature.begin(), kSignature.end(), bytes.begin())) {
    return false;
  }
  std::span<const uint8_t> rest = bytes.subspan(kSignature.size());
  png->compressed.reserve(bytes.size());
  Chunk chunk;
  if (!takeChunk(&rest, &chunk) || !readHeader(chunk, png)) return false;
  while (takeChunk(&rest, &chunk)) {
    if (chunk.type == "IEND") return true;
    if (chunk.type == "IDAT") {
      png->compressed.insert(png->compressed.end(), chunk.data.begin(), chunk.data.end());
    } else if (chunk.type == "eXIf" || chunk.type[0] < 'a') {
      return false;  // may turn the image, or is essential and unknown
    }
  }
  return false;
}

bool inflate(const std::vector<uint8_t>& compressed, std::vector<uint8_t>* raw) {
  const std::unique_ptr<libdeflate_decompressor, decltype(&libdeflate_free_decompressor)> decompressor(
      libdeflate_alloc_decompressor(), &libdeflate_free_decompressor);
  // Without a place for the actual size, success means that `raw` is filled exactly.
  return decompressor != nullptr &&
         libdeflate_zlib_decompress(decompressor.get(), compressed.data(), compressed.size(), raw->data(),
                                    raw->size(), nullptr) == LIBDEFLATE_SUCCESS;
}

}  // namespace

cv::Mat decodeGreyPng(std::span<const uint8_t> bytes) {
  GreyPng png;
  if (!readChunks(bytes, &png)) return {};
  const size_t raw_bytes = (static_cast<size_t>(png.width_px) + 1) * static_cast<size_t>(png.height_px);
  if (raw_bytes / kGreatestRatio > png.compressed.size()) return {};
  std::vector<uint8_t> raw(raw_bytes);
  if (!inflate(png.compressed, &raw)) return {};
  cv::Mat image(png.height_px, png.width_px, CV_8UC1);
  if (!png::unfilter(raw.data(), png.width_px, png.height_px, image.data)) return {};
  return image;
}

}  // namespace lodeline
