#include "lodeline/output/walls/depth/depth_jobs.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "lodeline/io/images/image_loader.h"

namespace lodeline {
namespace {

constexpr size_t kNeighbours = 2;  ///< on each side

/// The image in colour where the recording has colour, else the grey one.
cv::Mat colourOf(const PendingImage& image, const cv::Mat& grey) {
  if (!image.stored) return grey;
  const StoredImage stored = image.stored();
  const cv::Mat pixels =
      stored.pixels.empty() && !stored.file.empty() ? decodeStoredPixels(stored.file) : stored.pixels;
  if (pixels.channels() < 3 || pixels.depth() != CV_8U || pixels.size() != grey.size()) return grey;
  if (pixels.channels() == 3) return pixels;
  cv::Mat colour;
  cv::cvtColor(pixels, colour, cv::COLOR_BGRA2BGR);
  return colour;
}

}  // namespace

DepthJobs::DepthJobs(KeyframeViews& views, const RectifiedView& view, bool is_pair,
                     const DepthImageOptions& options)
    : views_(views), view_(view), is_pair_(is_pair), stereo_(view, options), sweep_(view, options) {}

std::optional<DepthJob> DepthJobs::next() { return is_pair_ ? nextPair() : nextSweep(); }

std::optional<DepthJob> DepthJobs::nextPair() {
  const std::optional<KeyframeView> keyframe = views_.next();
  if (!keyframe) return std::nullopt;
  return DepthJob{keyframe->number, keyframe->time, keyframe->map_from_body * view_.body_from_view(),
                  [this, keyframe = *keyframe] { return pairDepth(keyframe); }};
}

DepthImage DepthJobs::pairDepth(const KeyframeView& keyframe) const {
  const cv::Mat first = keyframe.images[0].load().image, second = keyframe.images[1].load().image;
  const cv::Size size(view_.pinhole().width_px, view_.pinhole().height_px);
  DepthImage result(size);
  result.colour = cv::Mat(size, CV_8U, cv::Scalar(0));
  if (first.empty() || second.empty()) return result;
  result = stereo_.compute(view_.rectify(0, first), view_.rectify(1, second));
  result.colour = view_.rectify(0, colourOf(keyframe.images[0], first));
  return result;
}

std::optional<DepthJob> DepthJobs::nextSweep() {
  while (window_.size() < middle_ + 1 + kNeighbours) {
    std::optional<KeyframeView> keyframe = views_.next();
    if (!keyframe) break;
    auto frame = std::make_shared<Frame>();
    frame->map_from_view = keyframe->map_from_body * view_.body_from_view();
    frame->keyframe = std::move(*keyframe);
    window_.push_back(std::move(frame));
  }
  if (middle_ >= window_.size()) return std::nullopt;
  std::vector<std::shared_ptr<Frame>> frames(window_.begin(), window_.end());
  const Frame& frame = *frames[middle_];
  DepthJob job{frame.keyframe.number, frame.keyframe.time, frame.map_from_view,
               [this, frames, middle = middle_] { return sweepDepth(frames, middle); }};
  if (middle_ < kNeighbours) {
    ++middle_;
  } else {
    window_.pop_front();
  }
  return job;
}

void DepthJobs::decode(Frame* frame) const {
  const cv::Mat grey = frame->keyframe.images[0].load().image;
  if (grey.empty()) return;
  frame->grey = view_.rectify(0, grey);
  frame->colour = view_.rectify(0, colourOf(frame->keyframe.images[0], grey));
}

DepthImage DepthJobs::sweepDepth(const std::vector<std::shared_ptr<Frame>>& frames, size_t middle) const {
  std::vector<SweepFrame> before, after;
  for (size_t i = 0; i < frames.size(); ++i) {
    Frame& frame = *frames[i];
    std::call_once(frame.once, [&] { decode(&frame); });
    if (i != middle && !frame.grey.empty())
      (i < middle ? before : after).push_back({frame.map_from_view, frame.grey});
  }
  const Frame& keyframe = *frames[middle];
  DepthImage result(cv::Size(view_.pinhole().width_px, view_.pinhole().height_px));
  if (!keyframe.grey.empty()) result = sweep_.compute({keyframe.map_from_view, keyframe.grey}, before, after);
  result.colour =
      keyframe.grey.empty() ? cv::Mat(result.depth.size(), CV_8U, cv::Scalar(0)) : keyframe.colour;
  return result;
}

}  // namespace lodeline
