#include "lodeline/features/structure_tensor.h"

#include <algorithm>
#include <cmath>

namespace lodeline {
namespace {

constexpr int kSide = 2 * StructureTensor::kWindowRadius + 1;

}  // namespace

StructureTensor::StructureTensor(const cv::Mat& image, const cv::Rect& cell)
    : width_(cell.width),
      height_(cell.height),
      wide_(cell.width + 2 * kWindowRadius),
      high_(cell.height + 2 * kWindowRadius) {
  const size_t count = static_cast<size_t>(wide_) * static_cast<size_t>(high_);
  xx_.resize(count);
  xy_.resize(count);
  yy_.resize(count);
  for (int row = 0; row < high_; ++row) {
    const int y = cell.y + row - kWindowRadius;
    const auto* above = image.ptr<float>(y - 1) + cell.x - kWindowRadius;
    const auto* here = image.ptr<float>(y) + cell.x - kWindowRadius;
    const auto* below = image.ptr<float>(y + 1) + cell.x - kWindowRadius;
    const size_t start = static_cast<size_t>(row) * static_cast<size_t>(wide_);
    for (int column = 0; column < wide_; ++column) {
      const float gx = here[column + 1] - here[column - 1];
      const float gy = below[column] - above[column];
      const size_t i = start + static_cast<size_t>(column);
      xx_[i] = gx * gx;
      xy_[i] = gx * gy;
      yy_[i] = gy * gy;
    }
  }
  for (std::vector<float>* products : {&xx_, &xy_, &yy_}) sumWindows(*products);
}

float StructureTensor::weakerGradientGreyPerPx(int column, int row) const {
  // Differences span two pixels.
  constexpr float kSpan = 2.0F;
  constexpr float kScale = 1.0F / (static_cast<float>(kSide * kSide) * kSpan * kSpan);
  const size_t i = static_cast<size_t>(row) * static_cast<size_t>(wide_) + static_cast<size_t>(column);
  const float mean = 0.5F * (xx_[i] + yy_[i]), difference = 0.5F * (xx_[i] - yy_[i]);
  return std::sqrt(std::max(0.0F, kScale * (mean - std::sqrt(difference * difference + xy_[i] * xy_[i]))));
}

/// Entry (column, row) becomes the sum over the window whose upper left corner it is.
void StructureTensor::sumWindows(std::vector<float>& values) const {
  for (int row = 0; row < high_; ++row) {
    float* line = values.data() + static_cast<ptrdiff_t>(row) * wide_;
    for (int column = 0; column < width_; ++column) {
      float sum = 0.0F;
      for (int k = 0; k < kSide; ++k) sum += line[column + k];
      line[column] = sum;
    }
  }
  for (int row = 0; row < height_; ++row) {
    float* line = values.data() + static_cast<ptrdiff_t>(row) * wide_;
    for (int k = 1; k < kSide; ++k) {
      const float* other = line + static_cast<ptrdiff_t>(k) * wide_;
      for (int column = 0; column < width_; ++column) line[column] += other[column];
    }
  }
}

}  // namespace lodeline
