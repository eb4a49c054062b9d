#include "lodeline/mapping/store/pack/deflate.h"

#include <zlib.h>

#include <new>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

/// The sign leaves the header out. A window of 1 kB and a small memory serve planes of some hundred bytes,
/// and take no time to set up.
constexpr int kPackedWindow = -10;
constexpr int kMemoryLevel = 5;
constexpr int kLargestWindow = -15;

}  // namespace

std::vector<unsigned char> deflated(std::span<const unsigned char> bytes) {
  z_stream stream{};
  if (deflateInit2(&stream, Z_BEST_COMPRESSION, Z_DEFLATED, kPackedWindow, kMemoryLevel,
                   Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
  std::vector<unsigned char> result(deflateBound(&stream, bytes.size()));
  stream.next_in = const_cast<unsigned char*>(bytes.data());
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = result.data();
  stream.avail_out = static_cast<uInt>(result.size());
  deflate(&stream, Z_FINISH);
  result.resize(stream.total_out);
  deflateEnd(&stream);
  return result;
}

std::vector<unsigned char> inflated(std::span<const unsigned char> bytes, size_t size) {
  z_stream stream{};
  if (inflateInit2(&stream, kLargestWindow) != Z_OK) throw std::bad_alloc();
  std::vector<unsigned char> result(size);
  stream.next_in = const_cast<unsigned char*>(bytes.data());
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = result.data();
  stream.avail_out = static_cast<uInt>(result.size());
  const int code = inflate(&stream, Z_FINISH);
  const bool is_good = code == Z_STREAM_END && stream.total_out == size && stream.avail_in == 0;
  inflateEnd(&stream);
  if (!is_good) throw InputError("the compressed data is damaged");
  return result;
}

}  // namespace lodeline
