#include "lodeline/data/image_loader.h"

#include <fmt/core.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "lodeline/data/grey_png.h"

namespace lodeline {
namespace {

bool readFile(const std::filesystem::path& file, std::vector<uint8_t>* bytes) {
  std::error_code error;
  const auto size =
      std::filesystem::is_regular_file(file, error) ? std::filesystem::file_size(file, error) : 0;
  if (error || size == 0) return false;
  bytes->resize(size);
  std::ifstream stream(file, std::ios::binary);
  stream.read(reinterpret_cast<char*>(bytes->data()), static_cast<std::streamsize>(size));
  return static_cast<bool>(stream);
}

}  // namespace

LoadedImage loadGreyImage(const std::filesystem::path& file) {
  LoadedImage result;
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) {
    result.problem = fmt::format("{}: image missing", file.string());
    return result;
  }
  std::vector<uint8_t> bytes;
  if (!readFile(file, &bytes)) {
    result.problem = fmt::format("{}: image file empty or unreadable", file.string());
    return result;
  }
  try {
    result.image = decodeGreyPng(bytes);
    if (result.image.empty()) result.image = cv::imdecode(bytes, cv::IMREAD_GRAYSCALE);
  } catch (const cv::Exception& error) {
    result.image.release();
    result.problem = fmt::format("{}: image damaged ({})", file.string(), error.what());
    return result;
  }
  if (result.image.empty())
    result.problem = fmt::format("{}: image damaged or of unknown kind", file.string());
  return result;
}

}  // namespace lodeline
