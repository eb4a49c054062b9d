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

bool isJpeg(std::span<const uint8_t> bytes) {
  return bytes.size() > 2 && bytes[0] == 0xff && bytes[1] == 0xd8;
}

/// Whether a JPEG file was cut off: the decoder fills up with one row and says nothing. Some
/// cameras leave out the end marker of whole images, so its absence alone means nothing.
bool isCutOffJpeg(std::span<const uint8_t> bytes, const cv::Mat& image) {
  constexpr size_t kTail = 4096;
  constexpr int kRows = 8;  // of a block
  constexpr std::array<uint8_t, 2> kEnd = {0xff, 0xd9};
  const auto tail = bytes.last(std::min(kTail, bytes.size()));
  if (!isJpeg(bytes) || std::search(tail.begin(), tail.end(), kEnd.begin(), kEnd.end()) != tail.end())
    return false;
  if (image.rows <= kRows) return false;
  const cv::Mat last = image.row(image.rows - 1);
  for (int row = image.rows - kRows; row < image.rows; ++row) {
    if (cv::countNonZero(image.row(row) != last) > 0) return false;
  }
  return true;
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

cv::Mat greyFrom(const cv::Mat& pixels, const GreyRange& range) {
  cv::Mat grey = pixels;
  if (pixels.channels() == 3) cv::cvtColor(pixels, grey, cv::COLOR_BGR2GRAY);
  if (pixels.channels() == 4) cv::cvtColor(pixels, grey, cv::COLOR_BGRA2GRAY);
  if (grey.depth() != CV_16U) return grey;
  cv::Mat scaled(grey.size(), CV_8UC1);
  for (int row = 0; row < grey.rows; ++row) {
    std::transform(grey.ptr<uint16_t>(row), grey.ptr<uint16_t>(row) + grey.cols, scaled.ptr<uint8_t>(row),
                   [&range](uint16_t value) { return range.grey(value); });
  }
  return scaled;
}

cv::Mat decodeStoredPixels(std::span<const uint8_t> bytes) {
  try {
    return cv::imdecode(cv::_InputArray(bytes.data(), static_cast<int>(bytes.size())), cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    return {};
  }
}

LoadedImage decodeGreyImage(std::span<const uint8_t> bytes, const std::string& name, const GreyRange& range) {
  LoadedImage result;
  const cv::_InputArray input(bytes.data(), static_cast<int>(bytes.size()));
  try {
    result.image = decodeGreyPng(bytes);
    if (result.image.empty() && !isJpeg(bytes)) {
      // Not by the decoder's own conversion: the same pixels must give the same grey in a bag.
      const cv::Mat pixels = cv::imdecode(input, cv::IMREAD_UNCHANGED);
      if (pixels.depth() == CV_8U || pixels.depth() == CV_16U) result.image = greyFrom(pixels, range);
    }
    if (result.image.empty()) result.image = cv::imdecode(input, cv::IMREAD_GRAYSCALE);
  } catch (const cv::Exception& error) {
    result.image.release();
    result.problem = fmt::format("{}: image damaged ({})", name, error.what());
    return result;
  }
  if (result.image.empty()) {
    result.problem = fmt::format("{}: image damaged or of unknown kind", name);
  } else if (isCutOffJpeg(bytes, result.image)) {
    result.image.release();
    result.problem = fmt::format("{}: image damaged: the file was cut off", name);
  }
  return result;
}

LoadedImage loadGreyImage(const std::filesystem::path& file, const GreyRange& range) {
  std::vector<uint8_t> bytes;
  const std::string problem = whyUnreadable(file, &bytes);
  if (!problem.empty()) return {cv::Mat(), problem};
  return decodeGreyImage(bytes, file.string(), range);
}

StoredImage loadStoredImage(const std::filesystem::path& file) {
  StoredImage image;
  image.problem = whyUnreadable(file, &image.file);
  return image;
}

}  // namespace lodeline
