#include "lodeline/mapping/control/control_residual.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

/// The point of an observation in the map, by the pose of its keyframe.
PositionPrior solvedPoint(const ControlFactor& factor, const SolvedPose& pose) {
  const Mat3 rotation = pose.map_from_body.rotation.toRotationMatrix();
  Eigen::Matrix<double, 3, 6> point_by_pose;
  point_by_pose << Mat3::Identity(), -so3::skew(rotation * factor.in_body.position);
  return {pose.map_from_body * factor.in_body.position,
          point_by_pose * pose.covariance * point_by_pose.transpose() +
              rotation * factor.in_body.covariance * rotation.transpose()};
}

/// Squared Mahalanobis distance of two independent positions.
double chiSquared(const PositionPrior& one, const PositionPrior& other) {
  const Vec3 error = one.position - other.position;
  return error.dot(Mat3(one.covariance + other.covariance).ldlt().solve(error));
}

/// Number of the observation with the least sum of distances to the others; one far distance counts as much
/// as another, so that blunders do not decide.
size_t mostAgreed(const std::vector<PositionPrior>& points) {
  size_t best = 0;
  double least = 0.0;
  for (size_t i = 0; i < points.size(); ++i) {
    double sum = 0.0;
    for (const PositionPrior& other : points) sum += std::min(chiSquared(points[i], other), kControlQuantile);
    if (i == 0 || sum < least) {
      best = i;
      least = sum;
    }
  }
  return best;
}

ControlPointResidual residualOf(const ControlFactor& factor, const PositionPrior& solved,
                                const PositionPrior& stated) {
  ControlPointResidual residual;
  residual.name = factor.name;
  residual.kind = factor.kind;
  residual.keyframe = factor.keyframe;
  residual.error_m = solved.position - stated.position;
  residual.sigma_m = (solved.covariance + stated.covariance).diagonal().cwiseSqrt();
  residual.chi_squared = chiSquared(solved, stated);
  residual.is_blunder = !(residual.chi_squared <= kControlQuantile);
  return residual;
}

/// An observation with its place in the list of factors.
struct SolvedObservation {
  const ControlFactor* factor;
  PositionPrior point;
};

}  // namespace

std::vector<ControlPointResidual> controlResiduals(std::span<const ControlFactor> factors,
                                                   const SolvedPoses& poses) {
  std::vector<SolvedObservation> observations;
  std::map<std::string, std::vector<size_t>> unknown;  // observations of points without a position, by name
  for (const ControlFactor& factor : factors) {
    const std::optional<SolvedPose> pose = poses(factor.keyframe);
    if (!pose) continue;
    if (!factor.in_map) unknown[factor.name].push_back(observations.size());
    observations.push_back({&factor, solvedPoint(factor, *pose)});
  }
  std::map<std::string, size_t> references;
  for (const auto& [name, numbers] : unknown) {
    std::vector<PositionPrior> points;
    for (const size_t number : numbers) points.push_back(observations[number].point);
    references[name] = numbers[mostAgreed(points)];
  }
  std::vector<ControlPointResidual> residuals;
  for (size_t i = 0; i < observations.size(); ++i) {
    const auto& [factor, point] = observations[i];
    if (factor->in_map) {
      residuals.push_back(residualOf(*factor, point, *factor->in_map));
      continue;
    }
    const SolvedObservation& reference = observations[references.at(factor->name)];
    ControlPointResidual residual = residualOf(*factor, point, reference.point);
    residual.reference_keyframe = reference.factor->keyframe;
    residuals.push_back(residual);
  }
  return residuals;
}

std::vector<std::string> blunderTexts(std::span<const ControlPointResidual> residuals) {
  std::vector<std::string> texts;
  for (const ControlPointResidual& residual : residuals) {
    if (!residual.is_blunder) continue;
    const std::string place = residual.reference_keyframe ? fmt::format("from where keyframe {} shows it",
                                                                        *residual.reference_keyframe)
                                                          : std::string("from its stated position");
    texts.push_back(
        fmt::format("{} '{}': keyframe {} shows it {:.2f} m {} (chi squared {:.1f}, expected below {:.1f})",
                    toString(residual.kind), residual.name, residual.keyframe, residual.error_m.norm(), place,
                    residual.chi_squared, kControlQuantile));
  }
  return texts;
}

std::string residualTable(std::span<const ControlPointResidual> residuals) {
  std::string text = fmt::format("{:<24} {:<8} {:>9} {:>8} {:>8} {:>8} {:>8}\n", "control point", "kind",
                                 "keyframe", "east m", "north m", "up m", "chi2");
  for (const ControlPointResidual& residual : residuals) {
    text +=
        fmt::format("{:<24} {:<8} {:>9} {:>8.2f} {:>8.2f} {:>8.2f} {:>8.1f}{}\n", residual.name,
                    toString(residual.kind), residual.keyframe, residual.error_m.x(), residual.error_m.y(),
                    residual.error_m.z(), residual.chi_squared, residual.is_blunder ? "  blunder" : "");
  }
  return text;
}

}  // namespace lodeline
