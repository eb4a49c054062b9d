#include "lodeline/output/files/sample_pictures.h"

#include <fmt/format.h>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "lodeline/frontend/draw_tracks.h"
#include "lodeline/util/files/output_file.h"

namespace lodeline {
namespace {

constexpr int kWidth_px = 640;
constexpr int kJpegQuality = 65;

/// Removes files with names of this class; the folder may contain other files of the user.
void removePictures(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> old;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string stem = entry.path().stem().string();
    const bool is_stamp = stem.find_first_not_of("0123456789") == std::string::npos;
    if (is_stamp && entry.path().extension() == ".jpg") old.push_back(entry.path());
  }
  for (const auto& file : old) std::filesystem::remove(file);
}

}  // namespace

std::vector<uint8_t> trackPicture(const FramePacket& packet, const FrontEnd& front_end, int max_width_px) {
  if (packet.images.front().empty()) return {};
  const cv::Mat& image = packet.images.front();
  cv::Mat picture = drawTracks(front_end, {image})(cv::Rect({0, 0}, image.size()));
  if (picture.cols > max_width_px) {
    const double scale = static_cast<double>(max_width_px) / picture.cols;
    cv::resize(picture, picture, {}, scale, scale, cv::INTER_AREA);
  }
  std::vector<uint8_t> jpeg;
  cv::imencode(".jpg", picture, jpeg, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
  return jpeg;
}

SamplePictures::SamplePictures(const std::filesystem::path& folder) : folder_(folder / "pictures") {
  createOutputFolder(folder_);
  removePictures(folder_);
}

void SamplePictures::write(const FramePacket& packet, const FrontEnd& front_end) {
  if (due_ && packet.time < *due_) return;
  const std::vector<uint8_t> jpeg = trackPicture(packet, front_end, kWidth_px);
  if (jpeg.empty()) return;
  due_ = packet.time + pause_;
  files_.push_back(folder_ / fmt::format("{}.jpg", packet.time.nanoseconds()));
  writeOutput(files_.back(), {reinterpret_cast<const char*>(jpeg.data()), jpeg.size()});
  if (files_.size() >= kMost) thin();
}

void SamplePictures::thin() {
  std::deque<std::filesystem::path> kept;
  for (size_t i = 0; i < files_.size(); ++i) {
    if (i % 2 == 0) {
      kept.push_back(files_[i]);
    } else {
      std::error_code ignored;  // one picture too many does no harm
      std::filesystem::remove(files_[i], ignored);
    }
  }
  files_ = std::move(kept);
  pause_ = pause_ + pause_;
}

}  // namespace lodeline
