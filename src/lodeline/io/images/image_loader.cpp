#include "lodeline/io/images/image_loader.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "lodeline/io/images/grey_png.h"

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

constexpr std::array<uint8_t, 2> kJpegEnd = {0xff, 0xd9};

bool hasEnd(std::span<const uint8_t> jpeg) {
  constexpr size_t kTail = 4096;
  const auto tail = jpeg.last(std::min(kTail, jpeg.size()));
  return std::search(tail.begin(), tail.end(), kJpegEnd.begin(), kJpegEnd.end()) != tail.end();
}

/// Whether the last rows of blocks have one grey level, with which a decoder fills missing data.
bool endsFilledUp(const cv::Mat& image) {
  constexpr int kRows = 8;
  if (image.rows <= kRows) return false;
  const cv::Mat rows = image.rowRange(image.rows - kRows, image.rows);
  return cv::countNonZero(rows != image.at<uint8_t>(image.rows - 1, image.cols - 1)) == 0;
}

/// Decodes a JPEG file without its end marker. Some cameras omit it from complete images, and truncated files
/// lack it.
LoadedImage decodeUnendedJpeg(std::span<const uint8_t> bytes, const std::string& name) {
  std::vector<uint8_t> ended(bytes.begin(), bytes.end());
  ended.insert(ended.end(), kJpegEnd.begin(), kJpegEnd.end());
  LoadedImage result{cv::imdecode(ended, cv::IMREAD_GRAYSCALE), {}};
  if (!result.image.empty() && !endsFilledUp(result.image)) return result;
  return {cv::Mat(), fmt::format("{}: image damaged: the file was cut off", name)};
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
    if (isJpeg(bytes) && !hasEnd(bytes)) return decodeUnendedJpeg(bytes, name);
    result.image = decodeGreyPng(bytes);
    if (result.image.empty() && !isJpeg(bytes)) {
      // The decoder's own grey conversion is not used, because the same pixels must give the same grey in a
      // bag.
      const cv::Mat pixels = cv::imdecode(input, cv::IMREAD_UNCHANGED);
      if (pixels.depth() == CV_8U || pixels.depth() == CV_16U) result.image = greyFrom(pixels, range);
    }
    if (result.image.empty()) result.image = cv::imdecode(input, cv::IMREAD_GRAYSCALE);
  } catch (const cv::Exception& error) {
    result.image.release();
    result.problem = fmt::format("{}: image damaged ({})", name, error.what());
    return result;
  }
  if (result.image.empty()) result.problem = fmt::format("{}: image damaged or of unknown kind", name);
  return result;
}

PendingImage imageInMemory(Time time, const cv::Mat& pixels) {
  const std::string name = fmt::format("image at {} ns", time.nanoseconds());
  return {time, name,
          [pixels] {
            return LoadedImage{greyFrom(pixels), ""};
          },
          [pixels] {
            return StoredImage{{}, pixels, ""};
          }};
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
