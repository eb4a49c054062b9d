#include "lodeline/magnetometer/calibration/heading/field_alignment.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

constexpr size_t kFewestPairs = 20;
using Mat9 = Eigen::Matrix<double, 9, 9>;
using Mat39 = Eigen::Matrix<double, 3, 9>;

struct Pair {
  Time from, to;
  Vec3 from_M, to_M;
};

std::vector<Pair> makePairs(std::span<const NormalizedFieldSample> field,
                            const FieldAlignmentOptions& options) {
  std::vector<Pair> pairs;
  size_t last = 0;
  for (const NormalizedFieldSample& first : field) {
    while (last < field.size() && (field[last].time - first.time).seconds() < options.step_s) ++last;
    if (last == field.size()) break;
    // Across a gap in the data, the gyroscope's own errors would be significant.
    if ((field[last].time - first.time).seconds() > 5.0 * options.step_s) continue;
    pairs.push_back({first.time, field[last].time, first.field_M, field[last].field_M});
  }
  const size_t stride = pairs.size() / static_cast<size_t>(options.most_pairs) + 1;
  std::vector<Pair> kept;
  for (size_t i = 0; i < pairs.size(); i += stride) kept.push_back(pairs[i]);
  return kept;
}

struct Solution {
  Mat3 rotation = Mat3::Identity();
  double mean_square = std::numeric_limits<double>::infinity();  ///< per axis, for the null vector
  double distinctness = 0.0;
  size_t pairs = 0;
};

Mat3 nearestRotation(const Mat3& matrix) {
  const Eigen::JacobiSVD<Mat3> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

Solution solveRotation(const std::vector<Pair>& pairs, const GyroscopePath& path, double time_offset_s) {
  const Duration offset = Duration::fromSeconds(time_offset_s);
  Mat9 normal = Mat9::Zero();
  Solution solution;
  for (const Pair& pair : pairs) {
    if (!path.covers(pair.from + offset) || !path.covers(pair.to + offset)) continue;
    const Quat from = path.at(pair.from + offset).start_from_body;
    const Mat3 to_from_from =
        (path.at(pair.to + offset).start_from_body.conjugate() * from).toRotationMatrix();
    Mat39 rows;
    for (int c = 0; c < 3; ++c) {
      rows.middleCols<3>(3 * c) = pair.to_M[c] * Mat3::Identity() - pair.from_M[c] * to_from_from;
    }
    normal += rows.transpose() * rows;
    ++solution.pairs;
  }
  if (solution.pairs < kFewestPairs) return solution;
  const Eigen::SelfAdjointEigenSolver<Mat9> solver(normal);
  const Eigen::Matrix<double, 9, 1> null = solver.eigenvectors().col(0);
  const Mat3 matrix = Eigen::Map<const Mat3>(null.data());
  solution.rotation = nearestRotation(matrix.determinant() < 0.0 ? Mat3(-matrix) : matrix);
  // The null vector has unit length, whereas a rotation matrix has norm sqrt(3).
  solution.mean_square = std::max(0.0, solver.eigenvalues()[0]) / static_cast<double>(solution.pairs);
  solution.distinctness = solver.eigenvalues()[1] / std::max(solver.eigenvalues()[0], 1e-300);
  return solution;
}

double bestTimeOffset(const std::vector<Pair>& pairs, const GyroscopePath& path, double greatest_s) {
  constexpr int kSteps = 10;  // in both directions
  double best_s = 0.0;
  double best = std::numeric_limits<double>::infinity();
  const auto look = [&](double offset_s) {
    const double value = solveRotation(pairs, path, offset_s).mean_square;
    if (value < best) {
      best = value;
      best_s = offset_s;
    }
  };
  for (int i = -kSteps; i <= kSteps; ++i) look(greatest_s * i / kSteps);
  for (double step_s = greatest_s / kSteps / 2.0; step_s > 2e-4; step_s /= 2.0) {
    const double middle_s = best_s;
    look(middle_s - step_s);
    look(middle_s + step_s);
  }
  return best_s;
}

Vec3 solveBias(const std::vector<Pair>& pairs, const GyroscopePath& path, const Mat3& rotation,
               double time_offset_s) {
  const Duration offset = Duration::fromSeconds(time_offset_s);
  Mat3 normal = 1e-12 * Mat3::Identity();
  Vec3 right = Vec3::Zero();
  for (const Pair& pair : pairs) {
    if (!path.covers(pair.from + offset) || !path.covers(pair.to + offset)) continue;
    const GyroscopePath::Point from = path.at(pair.from + offset);
    const GyroscopePath::Point to = path.at(pair.to + offset);
    const Quat to_from_from = to.start_from_body.conjugate() * from.start_from_body;
    const Mat3 by_bias = to.by_bias - to_from_from.toRotationMatrix() * from.by_bias;
    // dR(b + d)^T u = u + [u]x J d to first order, u = dR^T R z_1.
    const Vec3 carried = to_from_from * (rotation * pair.from_M);
    const Mat3 jacobian = so3::skew(carried) * by_bias;
    normal += jacobian.transpose() * jacobian;
    right += jacobian.transpose() * (rotation * pair.to_M - carried);
  }
  return normal.ldlt().solve(right);
}

}  // namespace

std::optional<FieldAlignment> alignField(std::span<const NormalizedFieldSample> field,
                                         std::span<const ImuSample> imu,
                                         const FieldAlignmentOptions& options) {
  const std::vector<Pair> pairs = makePairs(field, options);
  FieldAlignment alignment;
  constexpr int kRounds = 3;
  for (int round = 0; round < kRounds; ++round) {
    const GyroscopePath path(imu, alignment.gyroscope_bias_B);
    alignment.time_offset_s = bestTimeOffset(pairs, path, options.greatest_time_offset_s);
    const Solution solution = solveRotation(pairs, path, alignment.time_offset_s);
    if (solution.pairs < kFewestPairs) return std::nullopt;
    alignment.body_from_magnetometer = Quat(solution.rotation);
    alignment.residual = std::sqrt(solution.mean_square);
    alignment.distinctness = solution.distinctness;
    alignment.gyroscope_bias_B += solveBias(pairs, path, solution.rotation, alignment.time_offset_s);
  }
  return alignment;
}

}  // namespace lodeline
