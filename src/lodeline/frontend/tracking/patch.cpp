#include "lodeline/frontend/tracking/patch.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace lodeline {
namespace {

constexpr int kMaxIterations = 10;
constexpr float kConvergedStepPx = 0.01F;
/// Convergence limit of the linear part: a change of 0.1 px at the edge of the patch.
constexpr float kConvergedBend = 0.1F / PatchPattern::kReach;
/// Convergence limit on a coarse level, which only has to be within reach of the next finer one, px.
constexpr float kCoarseStepPx = 0.05F;
/// A patch with a smaller norm of its detrended values is noise.
constexpr float kMinContrastGrey = 3.0F;
/// Damping of the linear part relative to the information on the shift. It reduces steps in directions that a
/// patch with few edges hardly determines, and does not move the minimum.
constexpr float kDeformationDamping = 0.5F;
/// Determinant over squared trace of the information on the shift; an edge determines only one direction.
constexpr float kMinConditioning = 0.03F;
/// Patches whose area is reduced or enlarged by more than this factor have lost their point.
constexpr float kMinDeterminant = 0.25F;

PatchWarp atLevel(const PatchWarp& warp, int level) {
  return {warp.position / static_cast<float>(1 << level), warp.linear};
}

}  // namespace

bool PatchTemplate::fillLevel(const cv::Mat& image, const Eigen::Vector2f& centre, PatchMotion motion,
                              Level& level, Jacobian& jacobian, float& norm) {
  if (!staysInside(image, {centre, Eigen::Matrix2f::Identity()}, 1.0F)) return false;
  const PatchBlock block(image, centre);
  block.values(level.values);
  norm = normalize(level.values);
  if (norm < kMinContrastGrey) return false;

  block.gradients(1.0F / norm, jacobian[0], jacobian[1]);
  if (motion == PatchMotion::Deformation) {
    for (size_t i = 0; i < jacobian[0].size(); ++i) {
      jacobian[2][i] = jacobian[0][i] * kPatchU[i];
      jacobian[3][i] = jacobian[0][i] * kPatchV[i];
      jacobian[4][i] = jacobian[1][i] * kPatchU[i];
      jacobian[5][i] = jacobian[1][i] * kPatchV[i];
    }
  }
  const size_t parameters = motion == PatchMotion::Deformation ? kParameters : 2;
  for (size_t p = 0; p < parameters; ++p) projectOutNormalization(level.values, jacobian[p]);

  const float xx = dot(jacobian[0], jacobian[0]), yy = dot(jacobian[1], jacobian[1]);
  const float xy = dot(jacobian[0], jacobian[1]);
  const float determinant = xx * yy - xy * xy;
  if (!(determinant > kMinConditioning * (xx + yy) * (xx + yy))) return false;
  for (size_t i = 0; i < jacobian[0].size(); ++i) {
    level.shift_gain[0][i] = (yy * jacobian[0][i] - xy * jacobian[1][i]) / determinant;
    level.shift_gain[1][i] = (xx * jacobian[1][i] - xy * jacobian[0][i]) / determinant;
  }
  level.valid = true;
  return true;
}

void PatchTemplate::invertInformation() {
  using Information = Eigen::Matrix<float, kParameters, kParameters>;
  Information information;
  for (size_t r = 0; r < kParameters; ++r) {
    for (size_t c = 0; c <= r; ++c) {
      information(static_cast<int>(r), static_cast<int>(c)) =
          information(static_cast<int>(c), static_cast<int>(r)) = dot(jacobian_[r], jacobian_[c]);
    }
  }
  const float damping = kDeformationDamping * 0.5F * (information(0, 0) + information(1, 1)) *
                        PatchPattern::kReach * PatchPattern::kReach;
  information.diagonal().tail<kParameters - 2>().array() += damping;
  inverse_information_ = information.llt().solve(Information::Identity());
}

std::optional<PatchTemplate> PatchTemplate::extract(const ImagePyramid& image, const Eigen::Vector2f& centre,
                                                    int levels, PatchMotion motion) {
  PatchTemplate result;
  result.most_ = motion;
  levels = std::min(levels, image.levels());
  result.levels_.resize(static_cast<size_t>(levels));
  Jacobian coarse;
  for (int l = 0; l < levels; ++l) {
    float norm = 0.0F;
    const bool filled =
        fillLevel(image.level(l), centre / static_cast<float>(1 << l), l == 0 ? motion : PatchMotion::Shift,
                  result.levels_[static_cast<size_t>(l)], l == 0 ? result.jacobian_ : coarse, norm);
    if (l > 0) continue;
    if (!filled) return std::nullopt;
    result.contrast_grey_ = norm;
  }
  if (motion == PatchMotion::Deformation) result.invertInformation();
  return result;
}

bool PatchTemplate::shiftOnLevel(const Level& level, const cv::Mat& image, float converged_px,
                                 PatchWarp& warp, float& correlation) const {
  const Eigen::Vector2f start = warp.position;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    if (!staysInside(image, warp, 0.0F)) return false;
    PatchValues values;
    sample(image, warp, values);
    // The rows of the gain are orthogonal to the template, so it need not be subtracted from the values.
    const auto along =
        normalizedAlong<3>(values, {&level.values, &level.shift_gain[0], &level.shift_gain[1]});
    correlation = along[0];
    const Eigen::Vector2f move = warp.linear * Eigen::Vector2f(along[1], along[2]);
    warp.position -= move;
    if ((warp.position - start).squaredNorm() > PatchPattern::kReach * PatchPattern::kReach) return false;
    if (move.squaredNorm() < converged_px * converged_px) break;
  }
  return true;
}

bool PatchTemplate::deform(const cv::Mat& image, PatchWarp& warp, float& correlation) const {
  const Eigen::Vector2f start = warp.position;
  std::array<const PatchValues*, 1 + kParameters> rows{&levels_.front().values};
  for (size_t p = 0; p < jacobian_.size(); ++p) rows[1 + p] = &jacobian_[p];
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    if (!staysInside(image, warp, 0.0F)) return false;
    PatchValues values;
    sample(image, warp, values);
    const auto along = normalizedAlong(values, rows);
    correlation = along[0];
    // Like those of the gain, these rows are orthogonal to the template.
    const Eigen::Matrix<float, kParameters, 1> step =
        inverse_information_ * Eigen::Map<const Eigen::Matrix<float, kParameters, 1>>(along.data() + 1);
    Eigen::Matrix2f deformation;
    deformation << 1.0F + step[2], step[3], step[4], 1.0F + step[5];
    const float determinant = deformation.determinant();
    if (!(determinant > kMinDeterminant && determinant < 1.0F / kMinDeterminant)) return false;
    warp.linear = warp.linear * deformation.inverse();
    const Eigen::Vector2f move = warp.linear * Eigen::Vector2f(step[0], step[1]);
    warp.position -= move;
    if ((warp.position - start).squaredNorm() > PatchPattern::kReach * PatchPattern::kReach) return false;
    const float bend = std::max({std::abs(step[2]), std::abs(step[3]), std::abs(step[4]), std::abs(step[5])});
    if (move.squaredNorm() < kConvergedStepPx * kConvergedStepPx && bend < kConvergedBend) break;
  }
  const float determinant = warp.linear.determinant();
  return determinant > kMinDeterminant && determinant < 1.0F / kMinDeterminant;
}

std::optional<PatchMatch> PatchTemplate::align(const ImagePyramid& image, int coarsest, PatchMotion motion,
                                               PatchWarp& warp) const {
  float correlation = 0.0F;
  for (int l = std::min({coarsest, levels() - 1, image.levels() - 1}); l >= 0; --l) {
    const Level& level = levels_[static_cast<size_t>(l)];
    if (!level.valid) continue;
    PatchWarp scaled = atLevel(warp, l);
    const bool aligned = l == 0 && motion == PatchMotion::Deformation && most_ == PatchMotion::Deformation
                             ? deform(image.level(l), scaled, correlation)
                             : shiftOnLevel(level, image.level(l), l == 0 ? kConvergedStepPx : kCoarseStepPx,
                                            scaled, correlation);
    if (aligned) {
      warp = {scaled.position * static_cast<float>(1 << l), scaled.linear};
    } else if (l == 0) {
      return std::nullopt;
    }
  }
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
  sample(image.level(level), scaled, values);
  return normalizedAlong<1>(values, {&levels_[static_cast<size_t>(level)].values})[0];
}

}  // namespace lodeline
