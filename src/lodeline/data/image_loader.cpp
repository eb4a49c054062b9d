#include "lodeline/data/image_loader.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
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

std::string whyUnreadable(const std::filesystem::path& file, std::vector<uint8_t>* bytes) {
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return fmt::format("{}: image missing", file.string());
  if (!readFile(file, bytes)) return fmt::format("{}: image file empty or unreadable", file.string());
  return {};
}

}  // namespace

bool isPng(std::span<const uint8_t> bytes) {
  constexpr std::array<uint8_t, 8> kSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  return bytes.size() > kSignature.size() && std::equal(kSignature.begin(), kSignature.end(), bytes.begin());
}

cv::Mat greyFrom(const cv::Mat& pixels) {
  cv::Mat grey = pixels;
  if (pixels.channels() == 3) cv::cvtColor(pixels, grey, cv::COLOR_BGR2GRAY);
  if (pixels.channels() == 4) cv::cvtColor(pixels, grey, cv::COLOR_BGRA2GRAY);
  if (grey.depth() != CV_16U) return grey;
  cv::Mat upper(grey.size(), CV_8UC1);
  for (int row = 0; row < grey.rows; ++row) {
    std::transform(grey.ptr<uint16_t>(row), grey.ptr<uint16_t>(row) + grey.cols, upper.ptr<uint8_t>(row),
                   [](uint16_t value) { return static_cast<uint8_t>(value >> 8); });
  }
  return upper;
}

LoadedImage decodeGreyImage(std::span<const uint8_t> bytes, const std::string& name) {
  LoadedImage result;
  const cv::_InputArray input(bytes.data(), static_cast<int>(bytes.size()));
  try {
    result.image = decodeGreyPng(bytes);
    if (result.image.empty() && isPng(bytes)) {
      // Not by the decoder's own conversion: the same pixels must give the same grey in a bag.
      const cv::Mat pixels = cv::imdecode(input, cv::IMREAD_UNCHANGED);
      if (!pixels.empty()) result.image = greyFrom(pixels);
    } else if (result.image.empty()) {
      result.image = cv::imdecode(input, cv::IMREAD_GRAYSCALE);
    }
  } catch (const cv::Exception& error) {
    result.image.release();
    result.problem = fmt::format("{}: image damaged ({})", name, error.what());
    return result;
  }
  if (result.image.empty()) result.problem = fmt::format("{}: image damaged or of unknown kind", name);
  return result;
}

LoadedImage loadGreyImage(const std::filesystem::path& file) {
  std::vector<uint8_t> bytes;
  const std::string problem = whyUnreadable(file, &bytes);
  if (!problem.empty()) return {cv::Mat(), problem};
  return decodeGreyImage(bytes, file.string());
}

StoredImage loadStoredImage(const std::filesystem::path& file) {
  StoredImage image;
  image.problem = whyUnreadable(file, &image.file);
  return image;
}

}  // namespace lodeline
