#include "lodeline/frontend/detection/static_image_mask.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "lodeline/util/median.h"

namespace lodeline {
namespace {

constexpr int kUnit = 100;             // norm of a direction in a sample
constexpr int kTiles = 8;              // per row and per column of a sample
constexpr int kSide_px = 9;            // of the neighbourhood of a position
constexpr int kLargestWidth_px = 200;  // of a sample

int levelOfLooks(const ImagePyramid& image) {
  int level = 0;
  while (level + 1 < image.levels() && image.level(level).cols > kLargestWidth_px) ++level;
  return level;
}

/// Subtracts the local mean, i.e. the brightness gradients of a lamp's pool of light, which is fixed in the
/// image as well.
cv::Mat withoutSlopes(const cv::Mat& image) {
  cv::Mat mean;
  cv::boxFilter(image, mean, CV_32F, {kSide_px, kSide_px}, {-1, -1}, true, cv::BORDER_REFLECT);
  return image - mean;
}

/// Median absolute second difference, grey levels: where noise is stronger than texture, it measures the
/// noise. For mere noise after this front end's smoothing, gradients one level up are below 3 times this
/// value, those here below 4 times.
float detail(const cv::Mat& image) {
  std::vector<float> sizes;
  sizes.reserve(image.total() / 4 + 1);
  for (int row = 1; row + 1 < image.rows; row += 2) {
    const auto* grey = image.ptr<float>(row);
    for (int x = 1; x + 1 < image.cols; x += 2) {
      sizes.push_back(std::abs(grey[x - 1] - 2.0F * grey[x] + grey[x + 1]));
    }
  }
  return median(std::move(sizes));
}

}  // namespace

StaticImageMask::Look StaticImageMask::look(const ImagePyramid& pyramid) {
  constexpr size_t kLeastStrong = 8;  // of a tile
  constexpr float kLeast_grey = 0.5F, kStrong = 5.0F, kEcho = 0.25F;
  const int level = levelOfLooks(pyramid);
  const cv::Mat image = withoutSlopes(pyramid.level(level));
  cv::Mat x, y, size;
  const cv::Mat difference = (cv::Mat_<float>(1, 3) << -0.5F, 0.0F, 0.5F);
  cv::filter2D(image, x, CV_32F, difference);
  cv::filter2D(image, y, CV_32F, difference.t());
  cv::magnitude(x, y, size);
  // The subtraction of the local mean leaves artefacts beside strong texture.
  cv::Mat strongest;
  cv::dilate(size, strongest, cv::Mat::ones(kSide_px, kSide_px, CV_8U));
  size.setTo(0.0F, size < kEcho * strongest);

  const auto* sizes = size.ptr<float>();
  const int finer = std::clamp(level - 1, std::min(1, level), level);
  const float strong = std::max(kLeast_grey, kStrong * detail(pyramid.level(finer)));
  Look result{size.size(), std::vector<int8_t>(size.total(), 0), std::vector<int8_t>(size.total(), 0), {}};
  std::vector<std::vector<int>> tiles(kTiles * kTiles);
  for (size_t i = 0; i < size.total(); ++i) {
    if (sizes[i] < 0.5F * strong) continue;
    result.x[i] = static_cast<int8_t>(std::lround(kUnit * x.ptr<float>()[i] / sizes[i]));
    result.y[i] = static_cast<int8_t>(std::lround(kUnit * y.ptr<float>()[i] / sizes[i]));
    if (sizes[i] < strong) continue;
    const int index = static_cast<int>(i), column = index % size.cols, row = index / size.cols;
    tiles[static_cast<size_t>(row * kTiles / size.rows * kTiles + column * kTiles / size.cols)].push_back(
        index);
  }
  for (auto& tile : tiles) {
    if (tile.size() >= kLeastStrong) result.strong.push_back(std::move(tile));
  }
  return result;
}

bool StaticImageMask::agree(const Look& look, const Look& other) const {
  size_t same = 0;
  for (const std::vector<int>& tile : look.strong) {
    int64_t sum = 0;
    for (const int index : tile) {
      const auto i = static_cast<size_t>(index);
      sum += std::max(0, look.x[i] * other.x[i] + look.y[i] * other.y[i]);
    }
    same +=
        static_cast<double>(sum) > options_.max_agreement * kUnit * kUnit * static_cast<double>(tile.size())
            ? 1
            : 0;
  }
  return 2 * same > look.strong.size();
}

bool StaticImageMask::isKnown(const Look& look) const {
  return std::any_of(looks_.rbegin(), looks_.rend(), [&](const Look& other) { return agree(look, other); });
}

void StaticImageMask::count(const Look& look, int sign) {
  for (size_t i = 0; i < look.x.size(); ++i) {
    sum_x_[i] += sign * look.x[i];
    sum_y_[i] += sign * look.y[i];
  }
}

void StaticImageMask::add(Time time, const ImagePyramid& image) {
  constexpr size_t kLeastTiles = 4;
  if (!options_.enabled || image.empty()) return;
  const double interval_s = looks() < options_.max_looks ? options_.interval_s : options_.settled_interval_s;
  if (!first_ && (time - last_).seconds() < interval_s) return;
  first_ = false;
  last_ = time;
  const cv::Mat& small = image.level(levelOfLooks(image));
  Look now = look(image);
  if (now.strong.size() < kLeastTiles || isKnown(now)) return;

  sum_x_.resize(small.total(), 0);
  sum_y_.resize(small.total(), 0);
  if (looks() == options_.max_looks) {
    count(looks_.front(), -1);
    looks_.pop_front();
  }
  count(now, 1);
  looks_.push_back(std::move(now));
  if (looks() >= options_.min_looks) update(small.size(), image.level(0).size());
}

void StaticImageMask::update(cv::Size size, cv::Size image_size) {
  if (fixed_.empty()) fixed_ = cv::Mat::zeros(size, CV_8U);
  cv::Mat fixed(size, CV_8U);
  // The mean of unit vectors in independent directions is longer than this with a probability of exp(-9).
  constexpr double kChance = 3.0;
  const auto number = static_cast<double>(looks_.size());
  const double begin = kUnit * number * std::max(options_.min_persistence, kChance / std::sqrt(number));
  const double end = kUnit * number * options_.end_persistence;
  for (size_t i = 0; i < fixed.total(); ++i) {
    const double least = fixed_.data[i] != 0 ? end : begin;
    const double x = sum_x_[i], y = sum_y_[i];
    fixed.data[i] = x * x + y * y >= least * least ? 255 : 0;
  }
  // An isolated position is random.
  cv::Mat neighbours;
  cv::boxFilter(fixed, neighbours, CV_32F, {3, 3}, {-1, -1}, false, cv::BORDER_CONSTANT);
  fixed.setTo(0, neighbours < 1.5 * 255);
  if (cv::countNonZero(fixed != fixed_) == 0) return;
  fixed_ = fixed;

  // Morphological closing first: positions without texture between static ones belong to the same structure.
  const int margin = static_cast<int>(std::ceil(options_.margin_px * size.width / image_size.width));
  const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * margin + 1, 2 * margin + 1});
  cv::Mat wide;
  cv::dilate(fixed_, wide, disc, {-1, -1}, 2);
  cv::erode(wide, wide, disc);
  share_ = static_cast<double>(cv::countNonZero(wide)) / static_cast<double>(wide.total());
  if (share_ > options_.max_share) share_ = 0.0;
  mask_.release();
  if (share_ == 0.0) return;
  cv::resize(wide, mask_, image_size, 0.0, 0.0, cv::INTER_NEAREST);
  cv::bitwise_not(mask_, mask_);
}

}  // namespace lodeline
