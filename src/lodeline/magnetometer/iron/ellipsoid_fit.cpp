#include "lodeline/magnetometer/iron/ellipsoid_fit.h"

#include <Eigen/Dense>
#include <cmath>
#include <vector>

namespace lodeline {
namespace {

using Vec4 = Eigen::Matrix<double, 4, 1>;
using Vec6 = Eigen::Matrix<double, 6, 1>;
using Vec10 = Eigen::Matrix<double, 10, 1>;
using Mat4 = Eigen::Matrix4d;
using Mat64 = Eigen::Matrix<double, 6, 4>;
using Mat10 = Eigen::Matrix<double, 10, 10>;

constexpr size_t kFewestPoints = 9;
/// Minimum eigenvalue relative to the largest; below it, the points are on a plane or line.
constexpr double kFlat = 1e-12;

Vec10 monomials(const Vec3& p) {
  const double x = p.x(), y = p.y(), z = p.z();
  Vec10 row;
  row << x * x, y * y, z * z, 2 * y * z, 2 * x * z, 2 * x * y, 2 * x, 2 * y, 2 * z, 1.0;
  return row;
}

/// Inverse of the constraint matrix C_1 of the paper for k = 4.
Mat6 inverseConstraint() {
  Mat6 c = Mat6::Zero();
  c.topLeftCorner<3, 3>() << -1, 1, 1, 1, -1, 1, 1, 1, -1;
  c.bottomRightCorner<3, 3>() = -4.0 * Mat3::Identity();
  return c.inverse();
}

/// The one eigenvector with a positive eigenvalue.
std::optional<Vec6> positiveEigenvector(const Mat6& matrix) {
  const Eigen::EigenSolver<Mat6> solver(matrix);
  if (solver.info() != Eigen::Success) return std::nullopt;
  Eigen::Index best = 0;
  solver.eigenvalues().real().maxCoeff(&best);
  return solver.eigenvectors().col(best).real();
}

std::optional<Ellipsoid> fromCoefficients(const Vec6& quadratic, const Vec4& linear) {
  Mat3 m;
  m << quadratic[0], quadratic[5], quadratic[4], quadratic[5], quadratic[1], quadratic[3], quadratic[4],
      quadratic[3], quadratic[2];
  const Eigen::FullPivLU<Mat3> lu(m);
  if (!lu.isInvertible()) return std::nullopt;
  Ellipsoid ellipsoid;
  ellipsoid.centre = -lu.solve(linear.head<3>());
  const double level = ellipsoid.centre.dot(m * ellipsoid.centre) - linear[3];
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(m / level);
  if (!(solver.eigenvalues().minCoeff() > 0.0)) return std::nullopt;
  ellipsoid.matrix = solver.operatorSqrt();
  return ellipsoid;
}

/// Points shifted to zero mean and scaled to unit spread for numerical accuracy.
struct Normalized {
  Vec3 mean = Vec3::Zero();
  double scale = 0.0;
  std::vector<Vec3> points;
  bool flat = true;  ///< the points are on a plane or line
};

Normalized normalize(std::span<const Vec3> points) {
  Normalized result;
  const double count = static_cast<double>(points.size());
  for (const Vec3& p : points) result.mean += p / count;
  Mat3 spread = Mat3::Zero();
  for (const Vec3& p : points) spread += (p - result.mean) * (p - result.mean).transpose() / count;
  result.scale = std::sqrt(spread.trace());
  const Vec3 extents = Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvalues();
  result.flat = !(extents.minCoeff() > kFlat * extents.maxCoeff());
  if (result.flat) return result;
  for (const Vec3& p : points) result.points.push_back((p - result.mean) / result.scale);
  return result;
}

}  // namespace

Vec3 Ellipsoid::semiAxes() const {
  return Eigen::SelfAdjointEigenSolver<Mat3>(matrix).eigenvalues().cwiseInverse();
}

std::optional<Ellipsoid> fitEllipsoid(std::span<const Vec3> points) {
  if (points.size() < kFewestPoints) return std::nullopt;
  const Normalized data = normalize(points);
  if (data.flat) return std::nullopt;
  Mat10 scatter = Mat10::Zero();
  for (const Vec3& p : data.points) {
    const Vec10 row = monomials(p);
    scatter += row * row.transpose();
  }
  const Mat64 s12 = scatter.topRightCorner<6, 4>();
  const Eigen::Matrix<double, 4, 6> eliminated =
      scatter.bottomRightCorner<4, 4>().ldlt().solve(s12.transpose());
  const std::optional<Vec6> quadratic =
      positiveEigenvector(inverseConstraint() * (scatter.topLeftCorner<6, 6>() - s12 * eliminated));
  if (!quadratic) return std::nullopt;
  std::optional<Ellipsoid> ellipsoid = fromCoefficients(*quadratic, -eliminated * *quadratic);
  if (!ellipsoid) return std::nullopt;
  ellipsoid->centre = data.mean + data.scale * ellipsoid->centre;
  ellipsoid->matrix /= data.scale;
  return ellipsoid;
}

std::optional<Ellipsoid> fitSphere(std::span<const Vec3> points) {
  if (points.size() < 4) return std::nullopt;
  const Normalized data = normalize(points);
  if (data.flat) return std::nullopt;
  Mat4 normal = Mat4::Zero();
  Vec4 right = Vec4::Zero();
  for (const Vec3& p : data.points) {
    const Vec4 row(2.0 * p.x(), 2.0 * p.y(), 2.0 * p.z(), 1.0);
    normal += row * row.transpose();
    right += row * p.squaredNorm();
  }
  const Vec4 solution = normal.ldlt().solve(right);
  const Vec3 centre = solution.head<3>();
  const double radius = std::sqrt(solution[3] + centre.squaredNorm());
  if (!std::isfinite(radius) || !(radius > 0.0)) return std::nullopt;
  return Ellipsoid{data.mean + data.scale * centre, Mat3::Identity() / (data.scale * radius)};
}

}  // namespace lodeline
