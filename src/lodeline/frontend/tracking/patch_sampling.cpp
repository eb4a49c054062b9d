#include "lodeline/frontend/tracking/patch_sampling.h"

#include <cmath>

#include "lodeline/util/simd_dispatch.h"

namespace lodeline {
namespace {

constexpr float sumOfSquares(const PatchValues& values) {
  float sum = 0.0F;
  for (const float value : values) sum += value * value;
  return sum;
}

constexpr float kInverseCount = 1.0F / static_cast<float>(kPatchSize);
constexpr float kInverseSpread = 1.0F / sumOfSquares(kPatchU);

float sum(const PatchValues& a) {
  std::array<float, 4> sums{};
  for (size_t i = 0; i < a.size(); i += 4) {
    for (size_t lane = 0; lane < 4; ++lane) sums[lane] += a[i + lane];
  }
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

/// `pixels` must not overlap the other arguments, or the loop could not be vectorized.
LODELINE_WIDE_VECTORS
void sampleWarped(const float* __restrict pixels, int stride, const PatchWarp& warp, PatchValues& values) {
  const float x0 = warp.position.x(), y0 = warp.position.y();
  const float a = warp.linear(0, 0), b = warp.linear(0, 1), c = warp.linear(1, 0), d = warp.linear(1, 1);
  for (size_t i = 0; i < values.size(); ++i) {
    const float x = x0 + a * kPatchU[i] + b * kPatchV[i];
    const float y = y0 + c * kPatchU[i] + d * kPatchV[i];
    const int column = static_cast<int>(x), row = static_cast<int>(y);
    const float fx = x - static_cast<float>(column), fy = y - static_cast<float>(row);
    const int p = row * stride + column;
    const float top = pixels[p] + fx * (pixels[p + 1] - pixels[p]);
    const float bottom = pixels[p + stride] + fx * (pixels[p + stride + 1] - pixels[p + stride]);
    values[i] = top + fy * (bottom - top);
  }
}

}  // namespace

bool staysInside(const cv::Mat& image, const PatchWarp& warp, float margin) {
  const Eigen::Vector2f reach = PatchPattern::kReach * warp.linear.cwiseAbs().rowwise().sum();
  const Eigen::Vector2f low = warp.position - reach, high = warp.position + reach;
  constexpr float kRounding = 0.01F;
  margin += kRounding;
  return low.x() >= margin && low.y() >= margin && high.x() <= static_cast<float>(image.cols - 1) - margin &&
         high.y() <= static_cast<float>(image.rows - 1) - margin;
}

void sample(const cv::Mat& image, const PatchWarp& warp, PatchValues& values) {
  sampleWarped(image.ptr<float>(), static_cast<int>(image.step1()), warp, values);
}

float dot(const PatchValues& a, const PatchValues& b) {
  std::array<float, 4> sums{};
  for (size_t i = 0; i < a.size(); i += 4) {
    for (size_t lane = 0; lane < 4; ++lane) sums[lane] += a[i + lane] * b[i + lane];
  }
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

void detrend(PatchValues& values) {
  const float mean = sum(values) * kInverseCount;
  const float slope_u = dot(values, kPatchU) * kInverseSpread;
  const float slope_v = dot(values, kPatchV) * kInverseSpread;
  for (size_t i = 0; i < values.size(); ++i) values[i] -= mean + slope_u * kPatchU[i] + slope_v * kPatchV[i];
}

float normalize(PatchValues& values) {
  detrend(values);
  const float norm = std::sqrt(dot(values, values));
  const float scale = norm > 0.0F ? 1.0F / norm : 0.0F;
  for (float& value : values) value *= scale;
  return norm;
}

template <size_t kRows>
std::array<float, kRows> normalizedAlong(const PatchValues& values,
                                         const std::array<const PatchValues*, kRows>& rows) {
  // All sums run in parallel; one after the other, each would wait for its own additions.
  using Lanes = Eigen::Array4f;
  const auto lanes = [](const PatchValues& of, size_t i) { return Eigen::Map<const Lanes>(of.data() + i); };
  Lanes constant = Lanes::Zero(), along_u = Lanes::Zero(), along_v = Lanes::Zero(), squares = Lanes::Zero();
  std::array<Lanes, kRows> along;
  along.fill(Lanes::Zero());
  // Subtracts a common offset, because the sums of squares would lose digits to it.
  const float pivot = values[kPatchSize / 2];
  for (size_t i = 0; i < values.size(); i += 4) {
    const Lanes value = lanes(values, i) - pivot;
    constant += value;
    along_u += value * lanes(kPatchU, i);
    along_v += value * lanes(kPatchV, i);
    squares += value.square();
    for (size_t row = 0; row < kRows; ++row) along[row] += value * lanes(*rows[row], i);
  }
  const float u = along_u.sum(), v = along_v.sum(), sum = constant.sum();
  const float squared = squares.sum() - sum * sum * kInverseCount - (u * u + v * v) * kInverseSpread;
  const float scale = squared > 0.0F ? 1.0F / std::sqrt(squared) : 0.0F;
  std::array<float, kRows> result;
  for (size_t row = 0; row < kRows; ++row) result[row] = scale * along[row].sum();
  return result;
}

template std::array<float, 1> normalizedAlong<1>(const PatchValues&,
                                                 const std::array<const PatchValues*, 1>&);
template std::array<float, 3> normalizedAlong<3>(const PatchValues&,
                                                 const std::array<const PatchValues*, 3>&);
template std::array<float, 7> normalizedAlong<7>(const PatchValues&,
                                                 const std::array<const PatchValues*, 7>&);

void projectOutNormalization(const PatchValues& normalized, PatchValues& column) {
  detrend(column);
  const float along = dot(column, normalized);
  for (size_t i = 0; i < column.size(); ++i) column[i] -= along * normalized[i];
}

PatchBlock::PatchBlock(const cv::Mat& image, const Eigen::Vector2f& centre) {
  const float left = centre.x() - kReach, top = centre.y() - kReach;
  const int column = static_cast<int>(left), row = static_cast<int>(top);
  const float fx = left - static_cast<float>(column), fy = top - static_cast<float>(row);
  const float w00 = (1.0F - fx) * (1.0F - fy), w01 = fx * (1.0F - fy), w10 = (1.0F - fx) * fy, w11 = fx * fy;
  for (int y = 0; y < kSide; ++y) {
    const float* upper = image.ptr<float>(row + y) + column;
    const float* lower = image.ptr<float>(row + y + 1) + column;
    float* out = values_.data() + y * kSide;
    for (int x = 0; x < kSide; ++x) {
      out[x] = w00 * upper[x] + w01 * upper[x + 1] + w10 * lower[x] + w11 * lower[x + 1];
    }
  }
}

void PatchBlock::values(PatchValues& values) const {
  for (size_t i = 0; i < values.size(); ++i) values[i] = *at(i);
}

void PatchBlock::gradients(float scale, PatchValues& by_u, PatchValues& by_v) const {
  scale *= 0.5F;
  for (size_t i = 0; i < by_u.size(); ++i) {
    const float* p = at(i);
    by_u[i] = scale * (p[1] - p[-1]);
    by_v[i] = scale * (p[kSide] - p[-kSide]);
  }
}

}  // namespace lodeline
