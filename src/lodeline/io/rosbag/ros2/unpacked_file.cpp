#include "lodeline/io/rosbag/ros2/unpacked_file.h"

#include <fmt/core.h>
#include <unistd.h>
#include <zstd.h>

#include <array>
#include <fstream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

constexpr std::array<char, 4> kZstd = {'\x28', '\xB5', '\x2F', '\xFD'};

bool isZstd(const std::filesystem::path& file) {
  std::array<char, 4> start{};
  std::ifstream stream(file, std::ios::binary);
  return stream.read(start.data(), start.size()) && start == kZstd;
}

/// Creates an empty temporary file with a unique name.
std::filesystem::path emptyTemporary() {
  std::string name = (std::filesystem::temp_directory_path() / "lodeline_bag_XXXXXX").string();
  const int descriptor = ::mkstemp(name.data());
  if (descriptor < 0) throw InputError(name + ": cannot be written; set TMPDIR to a folder with space");
  ::close(descriptor);
  return name;
}

}  // namespace

UnpackedFile::UnpackedFile(const std::filesystem::path& file) : path_(file) {
  if (!isZstd(file)) return;
  path_ = emptyTemporary();
  is_copy_ = true;
  try {
    unpack(file);
  } catch (...) {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
    throw;
  }
}

UnpackedFile::UnpackedFile(UnpackedFile&& other) noexcept
    : path_(std::move(other.path_)),
      is_copy_(std::exchange(other.is_copy_, false)),
      is_cut_off_(other.is_cut_off_) {}

UnpackedFile::~UnpackedFile() {
  std::error_code ignored;
  if (is_copy_) std::filesystem::remove(path_, ignored);
}

void UnpackedFile::unpack(const std::filesystem::path& file) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), &ZSTD_freeDCtx);
  std::vector<char> packed(ZSTD_DStreamInSize()), unpacked(ZSTD_DStreamOutSize());
  std::ifstream in(file, std::ios::binary);
  std::ofstream out(path_, std::ios::binary | std::ios::trunc);
  size_t state = 0;
  while (in) {
    in.read(packed.data(), static_cast<std::streamsize>(packed.size()));
    ZSTD_inBuffer input{packed.data(), static_cast<size_t>(in.gcount()), 0};
    bool is_full = true;
    while (input.pos < input.size || is_full) {
      ZSTD_outBuffer output{unpacked.data(), unpacked.size(), 0};
      const size_t before = input.pos;
      state = ZSTD_decompressStream(context.get(), &output, &input);
      if (ZSTD_isError(state) != 0) {
        throw InputError(
            fmt::format("{}: its zstd data is damaged ({})", file.string(), ZSTD_getErrorName(state)));
      }
      out.write(unpacked.data(), static_cast<std::streamsize>(output.pos));
      is_full = output.pos == output.size;
      if (input.pos == before && output.pos == 0) break;
    }
  }
  is_cut_off_ = state != 0;
  out.close();
  if (!out) {
    throw InputError(fmt::format("{}: could not be unpacked to {}; set TMPDIR to a folder with space",
                                 file.string(), path_.string()));
  }
}

}  // namespace lodeline
