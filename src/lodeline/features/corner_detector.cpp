#include "lodeline/features/corner_detector.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>

namespace lodeline {
namespace {

constexpr int kWindowRadius = 3;

struct Corner {
  Eigen::Vector2f pixel;
  float strength = 0.0F;
};

/// Sums of gradient products over a window around every pixel of a cell.
class StructureTensor {
 public:
  StructureTensor(const cv::Mat& image, const cv::Rect& cell) : width_(cell.width), height_(cell.height) {
    const int wide = width_ + 2 * kWindowRadius, high = height_ + 2 * kWindowRadius;
    xx_.assign(static_cast<size_t>(wide * high), 0.0F);
    xy_ = yy_ = xx_;
    for (int row = 0; row < high; ++row) {
      const int y = cell.y + row - kWindowRadius;
      const auto* above = image.ptr<uint16_t>(y - 1) + cell.x - kWindowRadius;
      const auto* here = image.ptr<uint16_t>(y) + cell.x - kWindowRadius;
      const auto* below = image.ptr<uint16_t>(y + 1) + cell.x - kWindowRadius;
      for (int column = 0; column < wide; ++column) {
        const auto gx = static_cast<float>(here[column + 1] - here[column - 1]);
        const auto gy = static_cast<float>(below[column] - above[column]);
        const auto i = static_cast<size_t>(row * wide + column);
        xx_[i] = gx * gx;
        xy_[i] = gx * gy;
        yy_[i] = gy * gy;
      }
    }
    for (std::vector<float>* sums : {&xx_, &xy_, &yy_}) sumWindows(*sums, wide, high);
  }

  /// Root-mean-square gradient across the weaker direction, grey levels per px.
  float strength(int column, int row) const {
    constexpr int kSide = 2 * kWindowRadius + 1;
    constexpr float kScale =
        1.0F / (kSide * kSide * 4.0F * ImagePyramid::kUnitsPerGreyLevel * ImagePyramid::kUnitsPerGreyLevel);
    const auto i = static_cast<size_t>(row * (width_ + 2 * kWindowRadius) + column);
    const float mean = 0.5F * (xx_[i] + yy_[i]), difference = 0.5F * (xx_[i] - yy_[i]);
    return std::sqrt(std::max(0.0F, kScale * (mean - std::sqrt(difference * difference + xy_[i] * xy_[i]))));
  }

 private:
  /// Entry (column, row) becomes the sum over the window whose upper left corner it is.
  void sumWindows(std::vector<float>& values, int wide, int high) const {
    constexpr int kSide = 2 * kWindowRadius + 1;
    for (int row = 0; row < high; ++row) {
      float* line = values.data() + row * wide;
      for (int column = 0; column < width_; ++column) {
        float sum = 0.0F;
        for (int k = 0; k < kSide; ++k) sum += line[column + k];
        line[column] = sum;
      }
    }
    for (int row = 0; row < height_; ++row) {
      float* line = values.data() + row * wide;
      for (int k = 1; k < kSide; ++k) {
        const float* other = line + k * wide;
        for (int column = 0; column < width_; ++column) line[column] += other[column];
      }
    }
  }

  int width_, height_;
  std::vector<float> xx_, xy_, yy_;
};

/// Marks the surroundings of points, so that none is taken too close to another.
class Occupancy {
 public:
  Occupancy(cv::Size size, const cv::Mat& mask, double distance_px)
      : radius_(static_cast<int>(std::lround(distance_px))) {
    free_ = mask.empty() ? cv::Mat(size, CV_8U, cv::Scalar(255)) : mask.clone();
  }
  void occupy(const Eigen::Vector2f& pixel) {
    const cv::Point centre(static_cast<int>(std::lround(pixel.x())),
                           static_cast<int>(std::lround(pixel.y())));
    cv::circle(free_, centre, radius_, cv::Scalar(0), cv::FILLED);
  }
  bool isFree(int x, int y) const { return free_.at<uint8_t>(y, x) != 0; }

 private:
  int radius_;
  cv::Mat free_;
};

}  // namespace

std::vector<Eigen::Vector2f> CornerDetector::detect(const ImagePyramid& image, const cv::Mat& mask,
                                                    const std::vector<Eigen::Vector2f>& occupied) const {
  const int level = image.levels() > 1 ? 1 : 0;
  const int scale = 1 << level;
  const cv::Mat& picture = image.level(level);
  const cv::Size size = image.level(0).size();
  Occupancy occupancy(size, mask, options_.min_distance_px);

  const double cell_px = std::sqrt(static_cast<double>(picture.rows) * picture.cols / options_.max_tracks);
  const int columns = std::max(1, static_cast<int>(std::lround(picture.cols / cell_px)));
  const int rows = std::max(1, static_cast<int>(std::lround(picture.rows / cell_px)));
  std::vector<bool> filled(static_cast<size_t>(columns * rows), false);
  for (const Eigen::Vector2f& pixel : occupied) {
    occupancy.occupy(pixel);
    const int column = std::clamp(static_cast<int>(pixel.x()) * columns / size.width, 0, columns - 1);
    const int row = std::clamp(static_cast<int>(pixel.y()) * rows / size.height, 0, rows - 1);
    filled[static_cast<size_t>(row * columns + column)] = true;
  }

  const int border = std::max(static_cast<int>(std::ceil(options_.border_px / scale)), kWindowRadius + 2);
  const cv::Rect usable(border, border, picture.cols - 2 * border, picture.rows - 2 * border);
  std::vector<Corner> corners;
  for (int i = 0; i < columns * rows; ++i) {
    if (filled[static_cast<size_t>(i)]) continue;
    const int left = picture.cols * (i % columns) / columns, top = picture.rows * (i / columns) / rows;
    const int right = picture.cols * (i % columns + 1) / columns;
    const int bottom = picture.rows * (i / columns + 1) / rows;
    const cv::Rect cell = cv::Rect(left, top, right - left, bottom - top) & usable;
    if (cell.empty()) continue;
    const StructureTensor tensor(picture, cell);
    Corner best;
    for (int y = 0; y < cell.height; ++y) {
      for (int x = 0; x < cell.width; ++x) {
        const float strength = tensor.strength(x, y);
        if (strength <= best.strength) continue;
        const int full_x = (cell.x + x) * scale, full_y = (cell.y + y) * scale;
        if (!occupancy.isFree(full_x, full_y)) continue;
        best = {Eigen::Vector2f(static_cast<float>(full_x), static_cast<float>(full_y)), strength};
      }
    }
    if (best.strength < options_.min_gradient_grey_per_px) continue;
    occupancy.occupy(best.pixel);
    corners.push_back(best);
  }
  std::stable_sort(corners.begin(), corners.end(),
                   [](const Corner& a, const Corner& b) { return a.strength > b.strength; });
  std::vector<Eigen::Vector2f> pixels;
  for (const Corner& corner : corners) pixels.push_back(corner.pixel);
  return pixels;
}

}  // namespace lodeline
