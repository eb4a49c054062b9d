#include "lodeline/frontend/detection/structure_tensor.h"

#include <Eigen/Core>

#include "lodeline/util/simd_dispatch.h"

namespace lodeline {
namespace {

constexpr int kSide = 2 * StructureTensor::kWindowRadius + 1;

/// Products of the differences at `width` pixels of a row.
LODELINE_WIDE_VECTORS
void multiplyGradients(const float* __restrict above, const float* __restrict here,
                       const float* __restrict below, int width, float* __restrict xx, float* __restrict xy,
                       float* __restrict yy) {
  for (int i = 0; i < width; ++i) {
    const float gx = here[i + 1] - here[i - 1];
    const float gy = below[i] - above[i];
    xx[i] = gx * gx;
    xy[i] = gx * gy;
    yy[i] = gy * gy;
  }
}

/// Sums over kSide rows that begin `stride` apart.
LODELINE_WIDE_VECTORS
void sumRows(const float* __restrict rows, int stride, int width, float* __restrict sums) {
  for (int i = 0; i < width; ++i) {
    float sum = 0.0F;
    for (int k = 0; k < kSide; ++k) sum += rows[k * stride + i];
    sums[i] = sum;
  }
}

}  // namespace

StructureTensor::StructureTensor(const cv::Mat& image, const cv::Rect& cell)
    : width_(cell.width), weaker_(static_cast<size_t>(cell.area())) {
  using Row = Eigen::Map<Eigen::ArrayXf>;
  const int wide = cell.width + 2 * kWindowRadius, high = cell.height + 2 * kWindowRadius;
  const auto size = static_cast<size_t>(wide) * static_cast<size_t>(high);
  std::vector<float> products(3 * size), columns(static_cast<size_t>(wide));
  std::vector<float> windows(3 * static_cast<size_t>(width_));
  for (int row = 0; row < high; ++row) {
    const int y = cell.y + row - kWindowRadius, x = cell.x - kWindowRadius;
    float* line = products.data() + static_cast<ptrdiff_t>(row) * wide;
    multiplyGradients(image.ptr<float>(y - 1) + x, image.ptr<float>(y) + x, image.ptr<float>(y + 1) + x, wide,
                      line, line + size, line + 2 * size);
  }
  // Differences span two pixels.
  constexpr float kSpan = 2.0F;
  constexpr float kScale = 1.0F / (static_cast<float>(kSide * kSide) * kSpan * kSpan);
  for (int row = 0; row < cell.height; ++row) {
    for (size_t kind = 0; kind < 3; ++kind) {
      sumRows(products.data() + kind * size + static_cast<ptrdiff_t>(row) * wide, wide, wide, columns.data());
      sumRows(columns.data(), 1, width_, windows.data() + kind * static_cast<size_t>(width_));
    }
    const Row xx(windows.data(), width_);
    const Row xy(windows.data() + width_, width_);
    const Row yy(windows.data() + static_cast<ptrdiff_t>(2) * width_, width_);
    const auto difference = 0.5F * (xx - yy);
    Row(weaker_.data() + static_cast<ptrdiff_t>(row) * width_, width_) =
        (kScale * (0.5F * (xx + yy) - (difference.square() + xy.square()).sqrt())).max(0.0F).sqrt();
  }
}

}  // namespace lodeline
