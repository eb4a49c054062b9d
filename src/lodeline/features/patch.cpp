#include "lodeline/features/patch.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>

namespace lodeline {
namespace {

/// Levels below this one estimate the linear part of the warp as well.
constexpr int kDeformableLevels = 2;
constexpr int kMaxIterations = 10;
constexpr float kConvergedStepPx = 0.01F;
/// A patch this weak, as the norm of its detrended values, is noise.
constexpr float kMinContrastGrey = 3.0F;
/// Damping of the linear part relative to the information on the shift: it slows the steps that a patch of
/// few edges determines badly, without moving the minimum.
constexpr float kDeformationDamping = 0.05F;

bool staysInside(const cv::Mat& image, const PatchWarp& warp, float margin) {
  const Eigen::Vector2f reach = PatchPattern::kReach * warp.linear.cwiseAbs().rowwise().sum();
  const Eigen::Vector2f low = warp.position - reach, high = warp.position + reach;
  constexpr float kRounding = 0.01F;
  margin += kRounding;
  return low.x() >= margin && low.y() >= margin && high.x() <= static_cast<float>(image.cols - 1) - margin &&
         high.y() <= static_cast<float>(image.rows - 1) - margin;
}

/// Bilinear values at the warped pattern, shifted by (dx, dy) pixels of the image. Caller has checked bounds.
void sample(const cv::Mat& image, const PatchWarp& warp, float dx, float dy, PatchValues& values) {
  const float x0 = warp.position.x() + dx, y0 = warp.position.y() + dy;
  const float a = warp.linear(0, 0), b = warp.linear(0, 1), c = warp.linear(1, 0), d = warp.linear(1, 1);
  const uint16_t* pixels = image.ptr<uint16_t>();
  const int stride = static_cast<int>(image.step1());
  for (size_t i = 0; i < values.size(); ++i) {
    const float x = x0 + a * kPatchU[i] + b * kPatchV[i];
    const float y = y0 + c * kPatchU[i] + d * kPatchV[i];
    const int column = static_cast<int>(x), row = static_cast<int>(y);
    const float fx = x - static_cast<float>(column), fy = y - static_cast<float>(row);
    const uint16_t* p = pixels + row * stride + column;
    const auto p00 = static_cast<float>(p[0]), p01 = static_cast<float>(p[1]);
    const auto p10 = static_cast<float>(p[stride]), p11 = static_cast<float>(p[stride + 1]);
    const float top = p00 + fx * (p01 - p00), bottom = p10 + fx * (p11 - p10);
    values[i] = top + fy * (bottom - top);
  }
}

constexpr float sumOfSquares(const PatchValues& values) {
  float sum = 0.0F;
  for (const float value : values) sum += value * value;
  return sum;
}

float dot(const PatchValues& a, const PatchValues& b) {
  std::array<float, 4> sums{};
  for (size_t i = 0; i < a.size(); i += 4) {
    for (size_t lane = 0; lane < 4; ++lane) sums[lane] += a[i + lane] * b[i + lane];
  }
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

float sum(const PatchValues& a) {
  std::array<float, 4> sums{};
  for (size_t i = 0; i < a.size(); i += 4) {
    for (size_t lane = 0; lane < 4; ++lane) sums[lane] += a[i + lane];
  }
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

/// Takes constant and linear trend out.
void detrend(PatchValues& values) {
  constexpr float kInverseCount = 1.0F / static_cast<float>(kPatchSize);
  constexpr float kInverseSpread = 1.0F / sumOfSquares(kPatchU);
  const float mean = sum(values) * kInverseCount;
  const float slope_u = dot(values, kPatchU) * kInverseSpread;
  const float slope_v = dot(values, kPatchV) * kInverseSpread;
  for (size_t i = 0; i < values.size(); ++i) values[i] -= mean + slope_u * kPatchU[i] + slope_v * kPatchV[i];
}

/// Detrends and scales to unit norm; returns the norm before.
float normalise(PatchValues& values) {
  detrend(values);
  const float norm = std::sqrt(dot(values, values));
  const float scale = norm > 0.0F ? 1.0F / norm : 0.0F;
  for (float& value : values) value *= scale;
  return norm;
}

PatchWarp atLevel(const PatchWarp& warp, int level) {
  return {warp.position / static_cast<float>(1 << level), warp.linear};
}

}  // namespace

bool PatchTemplate::fillLevel(const cv::Mat& image, const PatchWarp& where, Level& level, bool deformable,
                              float& norm) {
  if (!staysInside(image, where, 1.0F)) return false;
  sample(image, where, 0.0F, 0.0F, level.values);
  norm = normalise(level.values);
  if (norm < kMinContrastGrey * ImagePyramid::kUnitsPerGreyLevel) return false;

  PatchValues left, right, up, down;
  sample(image, where, -1.0F, 0.0F, left);
  sample(image, where, 1.0F, 0.0F, right);
  sample(image, where, 0.0F, -1.0F, up);
  sample(image, where, 0.0F, 1.0F, down);
  const Eigen::Matrix2f gradient_to_pattern = 0.5F / norm * where.linear.transpose();
  const int parameters = deformable ? kParameters : 2;
  std::array<PatchValues, kParameters> jacobian;
  for (size_t i = 0; i < left.size(); ++i) {
    const Eigen::Vector2f g = gradient_to_pattern * Eigen::Vector2f(right[i] - left[i], down[i] - up[i]);
    jacobian[0][i] = g.x();
    jacobian[1][i] = g.y();
    jacobian[2][i] = g.x() * kPatchU[i];
    jacobian[3][i] = g.x() * kPatchV[i];
    jacobian[4][i] = g.y() * kPatchU[i];
    jacobian[5][i] = g.y() * kPatchV[i];
  }
  // Derivative of the normalisation: trend and the template itself are projected out of each column.
  Eigen::Matrix<float, kParameters, kParameters> information;
  information.setIdentity();
  for (int r = 0; r < parameters; ++r) {
    PatchValues& column = jacobian[static_cast<size_t>(r)];
    detrend(column);
    const float along = dot(column, level.values);
    for (size_t i = 0; i < column.size(); ++i) column[i] -= along * level.values[i];
    for (int c = 0; c <= r; ++c) {
      information(r, c) = information(c, r) = dot(column, jacobian[static_cast<size_t>(c)]);
    }
  }
  const float shift_information = 0.5F * (information(0, 0) + information(1, 1));
  for (int r = 2; r < parameters; ++r) {
    information(r, r) +=
        kDeformationDamping * shift_information * PatchPattern::kReach * PatchPattern::kReach;
  }
  const float weakest =
      shift_information - std::hypot(0.5F * (information(0, 0) - information(1, 1)), information(0, 1));
  if (!(weakest > 1e-4F * shift_information)) return false;
  const Eigen::Matrix<float, kParameters, kParameters> inverse = information.inverse();
  for (int r = 0; r < parameters; ++r) {
    PatchValues& row = level.gain[static_cast<size_t>(r)];
    row.fill(0.0F);
    for (int c = 0; c < parameters; ++c) {
      const PatchValues& column = jacobian[static_cast<size_t>(c)];
      const float factor = inverse(r, c);
      for (size_t i = 0; i < row.size(); ++i) row[i] += factor * column[i];
    }
  }
  level.valid = true;
  return true;
}

std::optional<PatchTemplate> PatchTemplate::extract(const ImagePyramid& image, const PatchWarp& where,
                                                    int levels) {
  PatchTemplate result;
  levels = std::min(levels, image.levels());
  result.levels_.resize(static_cast<size_t>(levels));
  for (int l = 0; l < levels; ++l) {
    float norm = 0.0F;
    const bool filled = fillLevel(image.level(l), atLevel(where, l), result.levels_[static_cast<size_t>(l)],
                                  l < kDeformableLevels, norm);
    if (l > 0) continue;
    if (!filled) return std::nullopt;
    result.contrast_grey_ = norm / ImagePyramid::kUnitsPerGreyLevel;
  }
  return result;
}

bool PatchTemplate::alignLevel(const Level& level, const cv::Mat& image, bool deformable, PatchWarp& warp,
                               float& correlation) const {
  const Eigen::Vector2f start = warp.position;
  const size_t parameters = deformable ? kParameters : 2;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    if (!staysInside(image, warp, 0.0F)) return false;
    PatchValues values;
    sample(image, warp, 0.0F, 0.0F, values);
    normalise(values);
    correlation = dot(values, level.values);

    // The gain's rows are orthogonal to the template, so it need not be subtracted from the values.
    std::array<float, kParameters> step{};
    for (size_t r = 0; r < parameters; ++r) step[r] = dot(level.gain[r], values);
    const Eigen::Vector2f shift(step[0], step[1]);
    if (deformable) {
      Eigen::Matrix2f deformation;
      deformation << 1.0F + step[2], step[3], step[4], 1.0F + step[5];
      const float determinant = deformation.determinant();
      if (!(determinant > 0.3F && determinant < 3.0F)) return false;
      warp.linear = warp.linear * deformation.inverse();
    }
    const Eigen::Vector2f move = warp.linear * shift;
    warp.position -= move;
    if ((warp.position - start).squaredNorm() > PatchPattern::kReach * PatchPattern::kReach) return false;
    if (move.squaredNorm() < kConvergedStepPx * kConvergedStepPx) break;
  }
  return true;
}

std::optional<PatchMatch> PatchTemplate::align(const ImagePyramid& image, int coarsest,
                                               PatchWarp& warp) const {
  constexpr float kMinDeterminant = 0.25F, kMaxDeterminant = 4.0F;
  float correlation = 0.0F;
  for (int l = std::min({coarsest, levels() - 1, image.levels() - 1}); l >= 0; --l) {
    const Level& level = levels_[static_cast<size_t>(l)];
    if (!level.valid) continue;
    PatchWarp scaled = atLevel(warp, l);
    const bool aligned = alignLevel(level, image.level(l), l < kDeformableLevels, scaled, correlation);
    if (aligned) {
      warp = {scaled.position * static_cast<float>(1 << l), scaled.linear};
    } else if (l == 0) {
      return std::nullopt;
    }
  }
  const float determinant = warp.linear.determinant();
  if (!(determinant > kMinDeterminant && determinant < kMaxDeterminant)) return std::nullopt;
  PatchMatch match;
  match.correlation = correlation;
  const float unexplained = std::max(0.0F, 1.0F - correlation * correlation);
  match.residual_grey = contrast_grey_ * std::sqrt(unexplained / static_cast<float>(kPatchSize));
  return match;
}

std::optional<float> PatchTemplate::correlate(const ImagePyramid& image, int level,
                                              const PatchWarp& warp) const {
  if (level >= levels() || level >= image.levels() || !levels_[static_cast<size_t>(level)].valid) {
    return std::nullopt;
  }
  const PatchWarp scaled = atLevel(warp, level);
  if (!staysInside(image.level(level), scaled, 0.0F)) return std::nullopt;
  PatchValues values;
  sample(image.level(level), scaled, 0.0F, 0.0F, values);
  normalise(values);
  return dot(values, levels_[static_cast<size_t>(level)].values);
}

}  // namespace lodeline
