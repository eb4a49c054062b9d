#include "lodeline/features/stereo_rotation.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "lodeline/base/angles.h"

namespace lodeline {
namespace {

constexpr size_t kEnough = 20;
constexpr int kIterations = 10;
constexpr double kKept = 0.9;             // of what the frames before have said
constexpr double kSigma = 1.0 * kDegree;  // beforehand
constexpr double kLeastError_px = 0.2;    // below which errors weigh alike

}  // namespace

/// error_px = e(0), slope = -de/dtheta: small turns are linear.
struct StereoRotation::Equation {
  double error_px;
  Vec3 slope;

  double after(const Vec3& turn) const { return std::abs(error_px - slope.dot(turn)); }
};

std::vector<StereoRotation::Equation> StereoRotation::equationsOf(const std::vector<RayPair>& pairs) const {
  std::vector<Equation> equations;
  for (const RayPair& pair : pairs) {
    const Vec3 normal = second_from_first_.translation.cross(second_from_first_.rotation * pair.first);
    const double length = normal.norm();
    if (length < 1e-9) continue;  // cameras at one place have no epipolar planes
    const Vec3 n = normal / length;
    equations.push_back({focal_px_ * n.dot(pair.second), focal_px_ * pair.second.cross(n)});
  }
  return equations;
}

void StereoRotation::add(const std::vector<RayPair>& pairs) {
  const std::vector<Equation> equations = equationsOf(pairs);
  if (equations.size() < kEnough) return;
  information_ *= kKept;
  right_side_ *= kKept;
  Mat3 information;
  Vec3 right_side;
  for (int i = 0; i < kIterations; ++i) {
    information = information_;
    right_side = right_side_;
    for (const Equation& equation : equations) {
      const double weight = 1.0 / std::max(equation.after(turn_), kLeastError_px);
      information += weight * equation.slope * equation.slope.transpose();
      right_side += weight * equation.error_px * equation.slope;
    }
    turn_ = (information + Mat3::Identity() / (kSigma * kSigma)).ldlt().solve(right_side);
  }
  information_ = information;
  right_side_ = right_side;
  const auto medianAfter = [&](const Vec3& turn) {
    std::vector<double> errors;
    for (const Equation& equation : equations) errors.push_back(equation.after(turn));
    const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
    std::nth_element(errors.begin(), middle, errors.end());
    return *middle;
  };
  const double by_file_px = medianAfter(Vec3::Zero());
  found_ = found_ || (by_file_px > 0.5 * limit_px_ && medianAfter(turn_) < 0.5 * by_file_px);
}

}  // namespace lodeline
