#include "lodeline/frontend/stereo/stereo_rotation.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "lodeline/util/angles.h"
#include "lodeline/util/median.h"

namespace lodeline {
namespace {

// With fewer matches, three parameters may fit well by chance.
constexpr size_t kEnough = 60, kMost = 300;
constexpr int kIterations = 10;
constexpr double kSigma_rad = 1.0 * kDegree;  // beforehand
constexpr double kLeastError_px = 0.2;        // below which errors weigh alike

}  // namespace

std::optional<Vec3> epipolarNormal(const Rigid3& second_from_first, const Vec3& first_ray) {
  const Vec3 normal = second_from_first.translation.cross(second_from_first.rotation * first_ray);
  const double length = normal.norm();
  if (length < 1e-9) return std::nullopt;
  return normal / length;
}

void StereoRotation::remember(const RayPair& pair, const Rigid3& second_from_first) {
  const std::optional<Vec3> normal = epipolarNormal(pair.betweenOrigins(second_from_first), pair.first);
  if (!normal) return;
  newest_.push_back({focal_px_ * normal->dot(pair.second), focal_px_ * pair.second.cross(*normal)});
  if (newest_.size() > kMost) newest_.pop_front();
}

void StereoRotation::fit() {
  for (int i = 0; i < kIterations; ++i) {
    Mat3 information = Mat3::Identity() / (kSigma_rad * kSigma_rad);
    Vec3 right_side = Vec3::Zero();
    for (const Equation& equation : newest_) {
      const double weight = 1.0 / std::max(equation.after(turn_), kLeastError_px);
      information += weight * equation.slope * equation.slope.transpose();
      right_side += weight * equation.error_px * equation.slope;
    }
    turn_ = information.ldlt().solve(right_side);
  }
}

double StereoRotation::medianAfter(const Vec3& turn) const {
  std::vector<double> errors;
  for (const Equation& equation : newest_) errors.push_back(equation.after(turn));
  return median(std::move(errors));
}

void StereoRotation::add(const std::vector<RayPair>& pairs, const Rigid3& second_from_first) {
  for (const RayPair& pair : pairs) remember(pair, second_from_first);
  if (newest_.size() < kEnough) return;
  fit();
  const double by_file_px = medianAfter(Vec3::Zero());
  found_ = found_ || (by_file_px > 0.5 * limit_px_ && medianAfter(turn_) < 0.5 * by_file_px);
}

}  // namespace lodeline
