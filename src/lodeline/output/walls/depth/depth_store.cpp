#include "lodeline/output/walls/depth/depth_store.h"

#include <fmt/format.h>

#include <cstring>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "lodeline/util/files/output_file.h"

namespace lodeline {
namespace {

constexpr size_t kPictures = 3;

std::string packed(const cv::Mat& picture) {
  std::vector<uint8_t> bytes;
  cv::imencode(".png", picture, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1});
  std::string text(sizeof(uint64_t), '\0');
  const uint64_t size = bytes.size();
  std::memcpy(text.data(), &size, sizeof(size));
  return text.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

}  // namespace

void writeWhole(const std::filesystem::path& file, std::string_view bytes) {
  std::filesystem::path unfinished = file;
  unfinished += ".part";
  writeOutput(unfinished, bytes);
  std::error_code error;
  std::filesystem::rename(unfinished, file, error);
  if (error) throw InputError(fmt::format("{}: cannot be written ({})", file.string(), error.message()));
}

DepthStore::DepthStore(std::filesystem::path folder) : folder_(std::move(folder)) {
  createOutputFolder(folder_);
}

std::filesystem::path DepthStore::fileOf(size_t number) const {
  return folder_ / fmt::format("{:06}.depth", number);
}

void DepthStore::write(size_t number, const DepthImage& image) const {
  writeWhole(fileOf(number), packed(image.depth) + packed(image.sigma) + packed(image.colour));
}

DepthImage DepthStore::read(size_t number) const {
  const std::filesystem::path file = fileOf(number);
  std::ifstream stream(file, std::ios::binary);
  std::vector<cv::Mat> pictures;
  for (size_t i = 0; i < kPictures; ++i) {
    uint64_t size = 0;
    stream.read(reinterpret_cast<char*>(&size), sizeof(size));
    if (!stream || size > (1U << 30)) break;
    std::vector<uint8_t> bytes(size);
    stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
    if (stream) pictures.push_back(cv::imdecode(bytes, cv::IMREAD_UNCHANGED));
  }
  if (pictures.size() != kPictures || pictures[0].type() != CV_16U || pictures[1].type() != CV_8U ||
      pictures[1].size() != pictures[0].size() || pictures[2].size() != pictures[0].size()) {
    throw InputError(fmt::format("{}: damaged; delete the folder and start again", file.string()));
  }
  DepthImage image;
  image.depth = pictures[0];
  image.sigma = pictures[1];
  image.colour = pictures[2];
  return image;
}

}  // namespace lodeline
