#include "lodeline/cameras/brown_conrady.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace lodeline {
namespace {

constexpr double kMaxAngle_rad = 89.5 * std::numbers::pi / 180.0;
constexpr double kConvergedStep = 1e-12;
constexpr int kMaxIterations = 50;

}  // namespace

BrownConrady::BrownConrady(const std::vector<double>& parameters, size_t first) {
  const size_t count = std::min(parameters.size() - first, k_.size());
  std::copy_n(parameters.begin() + static_cast<std::ptrdiff_t>(first), count, k_.begin());
  max_radius_ = findMaxRadius();
}

namespace {

/// Unit vectors all around. The tangential part depends on the direction only through its sine and cosine, so
/// coarse steps suffice.
const std::array<Vec2, 36>& directions() {
  static const std::array<Vec2, 36> all = [] {
    std::array<Vec2, 36> vectors;
    for (size_t i = 0; i < vectors.size(); ++i) {
      const double phi =
          2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(vectors.size());
      vectors[i] = Vec2(std::cos(phi), std::sin(phi));
    }
    return vectors;
  }();
  return all;
}

}  // namespace

bool BrownConrady::isRegular(double radius) const {
  const double r2 = radius * radius;
  double slope = 0.0;
  const double factor = radialFactor(r2, &slope);
  // A negative factor means a point beyond a pole of the rational model.
  if (!(factor > 0.0) || !(factor + 2.0 * r2 * slope > 0.0)) return false;
  if (k_[2] == 0.0 && k_[3] == 0.0) return true;
  for (const Vec2& direction : directions()) {
    Mat2 jacobian;
    distort(radius * direction, &jacobian);
    if (!(jacobian.determinant() > 0.0)) return false;
  }
  return true;
}

double BrownConrady::findMaxRadius() const {
  constexpr int kSteps = 900;
  double good = 0.0;
  for (int i = 1; i <= kSteps; ++i) {
    double bad = std::tan(kMaxAngle_rad * i / kSteps);
    if (isRegular(bad)) {
      good = bad;
      continue;
    }
    while (bad - good > 1e-12 * (1.0 + bad)) {
      const double middle = 0.5 * (good + bad);
      (isRegular(middle) ? good : bad) = middle;
    }
    break;
  }
  return good;
}

Eigen::Matrix<double, 2, 8> BrownConrady::byCoefficients(const Vec2& undistorted) const {
  const double x = undistorted.x(), y = undistorted.y();
  const double r2 = x * x + y * y;
  const Vec3 powers(r2, r2 * r2, r2 * r2 * r2);
  const double denominator = 1.0 + k_[5] * powers[0] + k_[6] * powers[1] + k_[7] * powers[2];
  const Eigen::Matrix<double, 2, 3> by_numerator = undistorted / denominator * powers.transpose();
  Eigen::Matrix<double, 2, 8> by;
  by.leftCols<2>() = by_numerator.leftCols<2>();
  by.col(2) = Vec2(2.0 * x * y, r2 + 2.0 * y * y);
  by.col(3) = Vec2(r2 + 2.0 * x * x, 2.0 * x * y);
  by.col(4) = by_numerator.col(2);
  by.rightCols<3>() = -radialFactor(r2, nullptr) * by_numerator;
  return by;
}

double BrownConrady::invertRadial(double distorted_radius) const {
  double low = 0.0, high = max_radius_;
  double radius = std::min(distorted_radius, high);
  for (int i = 0; i < kMaxIterations; ++i) {
    double slope = 0.0;
    const double factor = radialFactor(radius * radius, &slope);
    const double error = radius * factor - distorted_radius;
    (error > 0.0 ? high : low) = radius;
    double next = radius - error / (factor + 2.0 * radius * radius * slope);
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    if (std::abs(next - radius) < 1e-9) return next;
    radius = next;
  }
  return radius;
}

std::optional<Vec2> BrownConrady::undistort(const Vec2& distorted) const {
  const double distorted_radius = distorted.norm();
  if (!std::isfinite(distorted_radius)) return std::nullopt;
  if (distorted_radius == 0.0) return Vec2::Zero();

  // Inverts the radial part in one dimension with a bracketed iteration. The small tangential part then needs
  // a few Newton steps in two dimensions.
  Vec2 undistorted = distorted * (invertRadial(distorted_radius) / distorted_radius);
  for (int i = 0; i < kMaxIterations; ++i) {
    Mat2 jacobian;
    const Vec2 error = distort(undistorted, &jacobian) - distorted;
    const Vec2 step = -(jacobian.inverse() * error);
    if (!step.allFinite()) return std::nullopt;
    undistorted += step;
    const double radius2 = undistorted.squaredNorm();
    if (step.norm() < kConvergedStep * (1.0 + std::sqrt(radius2))) {
      if (radius2 > max_radius_ * max_radius_) return std::nullopt;
      return undistorted;
    }
    if (radius2 > max_radius_ * max_radius_) undistorted *= max_radius_ / std::sqrt(radius2);
  }
  return std::nullopt;
}

}  // namespace lodeline
