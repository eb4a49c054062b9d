#include "lodeline/frontend/detection/corner_detector.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <opencv2/imgproc.hpp>

#include "lodeline/frontend/detection/particle_filter.h"
#include "lodeline/frontend/detection/structure_tensor.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

struct Corner {
  Eigen::Vector2f pixel = Eigen::Vector2f::Zero();
  float strength = 0.0F;
};

/// Marks the neighbourhood of points, in which no further point is taken.
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

/// Divides an image into about `count` square cells.
class Grid {
 public:
  Grid(cv::Size size, int count) : size_(size) {
    const double cell_px = std::sqrt(static_cast<double>(size.area()) / std::max(1, count));
    columns_ = std::max(1, static_cast<int>(std::lround(size.width / cell_px)));
    rows_ = std::max(1, static_cast<int>(std::lround(size.height / cell_px)));
  }
  int count() const { return columns_ * rows_; }
  cv::Rect cell(int index) const {
    const int column = index % columns_, row = index / columns_;
    const int left = size_.width * column / columns_, top = size_.height * row / rows_;
    return {left, top, size_.width * (column + 1) / columns_ - left, size_.height * (row + 1) / rows_ - top};
  }
  /// Index of the cell that contains a point: the last one whose rounded-down edge is not beyond it.
  int indexOf(const Eigen::Vector2f& point) const {
    return along(point.y(), rows_, size_.height) * columns_ + along(point.x(), columns_, size_.width);
  }

 private:
  static int along(float coordinate, int cells, int length) {
    return std::clamp(((static_cast<int>(coordinate) + 1) * cells - 1) / length, 0, cells - 1);
  }

  cv::Size size_;
  int columns_ = 1, rows_ = 1;
};

/// Finds corners in one cell of the image, which is `scale` times smaller than the original.
class CellSearch {
 public:
  CellSearch(const cv::Mat& picture, const cv::Rect& cell, int scale, const Occupancy& occupancy)
      : picture_(picture), cell_(cell), scale_(scale), occupancy_(occupancy), tensor_(picture, cell) {}

  /// Strongest free corner that does not belong to a particle. Strength zero where there is none: a cell with
  /// more than a few particles shows water and not rock.
  Corner strongestOnRock(float min_strength) {
    constexpr size_t kMostParticles = 3;
    while (particles_.size() <= kMostParticles) {
      const Corner best = strongest();
      if (best.strength < min_strength) break;
      const cv::Point corner = toPicture(best.pixel);
      if (!isParticle(picture_, corner)) return best;
      particles_.push_back(corner);
    }
    return {};
  }

 private:
  Corner strongest() const {
    Corner best;
    for (int y = 0; y < cell_.height; ++y) {
      for (int x = 0; x < cell_.width; ++x) {
        const float strength = tensor_.weakerGradientGreyPerPx(x, y);
        if (strength <= best.strength) continue;
        const cv::Point at = cell_.tl() + cv::Point(x, y);
        if (!occupancy_.isFree(at.x * scale_, at.y * scale_) || isOfParticle(at)) continue;
        best = {Eigen::Vector2f(static_cast<float>(at.x * scale_), static_cast<float>(at.y * scale_)),
                strength};
      }
    }
    return best;
  }
  cv::Point toPicture(const Eigen::Vector2f& pixel) const {
    return {static_cast<int>(pixel.x()) / scale_, static_cast<int>(pixel.y()) / scale_};
  }
  /// Whether a corner belongs to a particle found before. A dot causes corners wherever the tensor's window
  /// overlaps it.
  bool isOfParticle(const cv::Point& at) const {
    constexpr int kReach = 2 * StructureTensor::kWindowRadius + 1;
    return std::any_of(particles_.begin(), particles_.end(), [&](const cv::Point& particle) {
      return std::max(std::abs(at.x - particle.x), std::abs(at.y - particle.y)) <= kReach;
    });
  }

  const cv::Mat& picture_;
  cv::Rect cell_;
  int scale_;
  const Occupancy& occupancy_;
  StructureTensor tensor_;
  std::vector<cv::Point> particles_;
};

/// Mean absolute second difference, over steps of two pixels, in the smoothest tenth of an image's blocks,
/// grey levels: the sensor's noise, if part of the image is plain. Black or saturated blocks are skipped,
/// because they do not show it. With steps of two pixels its dependence on the smoothing is as small as that
/// of corner strengths.
double noiseGrey(const cv::Mat& picture) {
  constexpr int kBlock_px = 16;
  constexpr float kBlack_grey = 4.0F, kSaturated_grey = 250.0F;
  std::vector<double> blocks;
  for (int top = 0; top + kBlock_px <= picture.rows; top += kBlock_px) {
    for (int left = 0; left + kBlock_px <= picture.cols; left += kBlock_px) {
      float sum = 0.0F, darkest = kSaturated_grey, brightest = 0.0F;
      int count = 0;
      for (int y = top; y < top + kBlock_px; y += 2) {
        const auto* row = picture.ptr<float>(y);
        for (int x = left + 2; x + 2 < left + kBlock_px; x += 2, ++count) {
          sum += std::abs(row[x - 2] - 2.0F * row[x] + row[x + 2]);
          darkest = std::min(darkest, row[x]);
          brightest = std::max(brightest, row[x]);
        }
      }
      if (darkest > kBlack_grey && brightest < kSaturated_grey)
        blocks.push_back(static_cast<double>(sum) / count);
    }
  }
  return orderStatistic(std::move(blocks), 0.1);
}

}  // namespace

std::vector<Eigen::Vector2f> CornerDetector::detect(const ImagePyramid& image, const cv::Mat& mask,
                                                    const std::vector<Eigen::Vector2f>& occupied,
                                                    bool noisy) const {
  const int level = std::min(1, image.levels() - 1);
  const int scale = 1 << level;
  const cv::Mat& picture = image.level(level);
  const Grid grid(picture.size(), options_.max_tracks);
  Occupancy occupancy(image.level(0).size(), mask, options_.min_distance_px);
  std::vector<bool> filled(static_cast<size_t>(grid.count()), false);
  for (const Eigen::Vector2f& pixel : occupied) {
    occupancy.occupy(pixel);
    filled[static_cast<size_t>(grid.indexOf(pixel / static_cast<float>(scale)))] = true;
  }

  const int border = std::max({static_cast<int>(std::ceil(options_.border_px / scale)),
                               StructureTensor::kWindowRadius + 2, kParticleReachPx});
  const cv::Rect usable(border, border, picture.cols - 2 * border, picture.rows - 2 * border);
  const double noise_grey = noisy ? noiseGrey(picture) : 0.0;
  const auto least_gradient = static_cast<float>(
      std::max(options_.min_gradient_grey_per_px, options_.min_gradient_of_noise * noise_grey));
  std::vector<Corner> corners;
  for (int i = 0; i < grid.count(); ++i) {
    if (filled[static_cast<size_t>(i)]) continue;
    const cv::Rect cell = grid.cell(i) & usable;
    if (cell.empty()) continue;
    const Corner best = CellSearch(picture, cell, scale, occupancy).strongestOnRock(least_gradient);
    if (best.strength <= 0.0F) continue;
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
