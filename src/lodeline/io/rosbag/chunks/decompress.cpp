#include "lodeline/io/rosbag/chunks/decompress.h"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <memory>

namespace lodeline {
namespace {

/// Size at first of the unpacked bytes, which grow where needed: a damaged chunk may state any size.
size_t firstSize(size_t stated, size_t packed) {
  constexpr size_t kLeast = size_t{1} << 20;
  constexpr size_t kUsualRatio = 16;
  return std::min(stated, std::max(kLeast, packed * kUsualRatio));
}

/// Unpacks bzip2; its interface and bags both use 32-bit sizes.
Unpacked unpackBz2(std::span<const uint8_t> packed, size_t size) {
  Unpacked result;
  result.bytes.resize(size);
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) {
    return {{}, "not enough memory for bzip2"};
  }
  // bzip2's interface lacks const; the data is only read.
  stream.next_in = reinterpret_cast<char*>(const_cast<uint8_t*>(packed.data()));
  stream.avail_in = static_cast<unsigned>(packed.size());
  stream.next_out = reinterpret_cast<char*>(result.bytes.data());
  stream.avail_out = static_cast<unsigned>(size);
  int state = BZ_OK;
  while (state == BZ_OK && stream.avail_out > 0) {
    const unsigned before_in = stream.avail_in;
    const unsigned before_out = stream.avail_out;
    state = BZ2_bzDecompress(&stream);
    if (stream.avail_in == before_in && stream.avail_out == before_out) break;
  }
  result.bytes.resize(size - stream.avail_out);
  BZ2_bzDecompressEnd(&stream);
  if (result.bytes.size() < size) {
    result.problem =
        state == BZ_OK || state == BZ_STREAM_END ? "its bz2 data ends too early" : "its bz2 data is damaged";
  }
  return result;
}

Unpacked unpackLz4(std::span<const uint8_t> packed, size_t size) {
  Unpacked result;
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION)) != 0) {
    return {{}, "not enough memory for lz4"};
  }
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(
      raw, &LZ4F_freeDecompressionContext);
  result.bytes.resize(firstSize(size, packed.size()));
  size_t read = 0;
  size_t written = 0;
  while (written < size && read < packed.size()) {
    if (written == result.bytes.size()) result.bytes.resize(std::min(size, 2 * written));
    size_t in = packed.size() - read;
    size_t out = result.bytes.size() - written;
    const size_t state = LZ4F_decompress(context.get(), result.bytes.data() + written, &out,
                                         packed.data() + read, &in, nullptr);
    if (LZ4F_isError(state) != 0) {
      result.problem = std::string("its lz4 data is damaged (") + LZ4F_getErrorName(state) + ")";
      break;
    }
    if (in == 0 && out == 0) break;
    read += in;
    written += out;
  }
  result.bytes.resize(written);
  if (written < size && result.problem.empty()) result.problem = "its lz4 data ends too early";
  return result;
}

Unpacked unpackZstd(std::span<const uint8_t> packed, size_t size) {
  Unpacked result;
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), &ZSTD_freeDCtx);
  if (context == nullptr) return {{}, "not enough memory for zstd"};
  result.bytes.resize(firstSize(size, packed.size()));
  ZSTD_inBuffer in{packed.data(), packed.size(), 0};
  size_t written = 0;
  while (written < size) {
    if (written == result.bytes.size()) result.bytes.resize(std::min(size, 2 * written));
    ZSTD_outBuffer out{result.bytes.data(), result.bytes.size(), written};
    const size_t before = in.pos;
    const size_t state = ZSTD_decompressStream(context.get(), &out, &in);
    if (ZSTD_isError(state) != 0) {
      result.problem = std::string("its zstd data is damaged (") + ZSTD_getErrorName(state) + ")";
      break;
    }
    if (in.pos == before && out.pos == written) break;
    written = out.pos;
  }
  result.bytes.resize(written);
  if (written < size && result.problem.empty()) result.problem = "its zstd data ends too early";
  return result;
}

}  // namespace

Unpacked unpackChunk(const std::string& compression, std::span<const uint8_t> packed, size_t size) {
  if (compression == "bz2") return unpackBz2(packed, size);
  if (compression == "lz4") return unpackLz4(packed, size);
  if (compression == "zstd") return unpackZstd(packed, size);
  if (compression != "none" && !compression.empty())
    return {{}, "its compression '" + compression + "' is not known"};
  Unpacked result{
      {packed.begin(), packed.begin() + static_cast<std::ptrdiff_t>(std::min(size, packed.size()))}, {}};
  if (packed.size() < size) result.problem = "it is cut off";
  return result;
}

}  // namespace lodeline
