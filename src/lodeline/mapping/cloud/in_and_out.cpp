#include "lodeline/mapping/cloud/in_and_out.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <optional>

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/geometry/squared.h"

namespace lodeline {
namespace {

/// Least sigmas of a relative pose: beneath them, rounding of the reported covariances decides.
constexpr double kLeastSigma_m = 0.01;
constexpr double kLeastSigma_rad = 0.002;

std::vector<double> pathsOf(const std::vector<MapKeyframe>& keyframes) {
  std::vector<double> paths;
  for (size_t i = 0; i < keyframes.size(); ++i) {
    if (!keyframes[i].odom_from_body.matrix().allFinite() || !keyframes[i].covariance.allFinite())
      throw InputError(fmt::format("keyframe {} has no finite pose or covariance", keyframes[i].id));
    paths.push_back(i == 0 ? 0.0
                           : paths.back() + (keyframes[i].odom_from_body.translation -
                                             keyframes[i - 1].odom_from_body.translation)
                                                .norm());
  }
  return paths;
}

/// The nearest earlier keyframe within reach of the prediction.
std::optional<CloudPair> pairOf(const std::vector<MapKeyframe>& keyframes, const std::vector<double>& paths,
                                size_t later, const InAndOutOptions& options) {
  std::optional<size_t> best;
  double best_m = 0.0;
  const Rigid3& pose = keyframes[later].odom_from_body;
  for (size_t i = 0; i < later && paths[later] - paths[i] >= options.least_path_m; ++i) {
    const double distance_m = (keyframes[i].odom_from_body.translation - pose.translation).norm();
    if (!best || distance_m < best_m) {
      best = i;
      best_m = distance_m;
    }
  }
  if (!best) return std::nullopt;
  CloudPair pair;
  pair.old_index = *best;
  pair.new_index = later;
  pair.old_from_new = keyframes[*best].odom_from_body.inverse() * pose;
  pair.covariance = relativeCovariance(keyframes[*best], keyframes[later]);
  const Vec3 direction = pair.old_from_new.translation.normalized();
  const double sigma_m =
      best_m > 0.0 ? std::sqrt(direction.dot(pair.covariance.topLeftCorner<3, 3>() * direction)) : 0.0;
  if (best_m > options.most_distance_m + 3.0 * sigma_m) return std::nullopt;
  pair.looks_back = options.view_B.dot(pair.old_from_new.rotation * options.view_B) < 0.0;
  return pair;
}

double uncertaintyOf(const CloudPair& pair) { return pair.covariance.topLeftCorner<3, 3>().trace(); }

}  // namespace

void InAndOutOptions::check() const {
  if (!(spacing_m > 0.0) || !(least_path_m > 0.0) || !(most_distance_m > 0.0) || most_pairs < 1)
    throw UsageError("spacing, path, distance and number of pairs of clouds must be positive");
  if (std::abs(view_B.norm() - 1.0) > 1e-3) throw UsageError("view_B must be a unit vector");
}

Mat6 relativeCovariance(const MapKeyframe& earlier, const MapKeyframe& later) {
  const Vec3 lever = later.odom_from_body.translation - earlier.odom_from_body.translation;
  Mat6 transport = Mat6::Identity();
  transport.block<3, 3>(0, 3) = -so3::skew(lever);
  Mat6 covariance = later.covariance - transport * earlier.covariance * transport.transpose();
  // A heading that the magnetometer holds does not accumulate: the errors of both moments are independent.
  for (const MapKeyframe* keyframe : {&earlier, &later}) {
    if (keyframe->heading_sigma_rad) covariance(5, 5) += squared(*keyframe->heading_sigma_rad);
  }
  const Mat3 old_from_odom = earlier.odom_from_body.rotation.conjugate().toRotationMatrix();
  Mat6 turn = Mat6::Zero();
  turn.block<3, 3>(0, 0) = turn.block<3, 3>(3, 3) = old_from_odom;
  covariance = turn * covariance * turn.transpose();
  Eigen::Matrix<double, 6, 1> least;
  least << Vec3::Constant(kLeastSigma_m), Vec3::Constant(kLeastSigma_rad);
  // In units of the least sigmas, no variance may be less than one.
  const Mat6 scaled = least.cwiseInverse().asDiagonal() * covariance * least.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Mat6> solver(0.5 * (scaled + scaled.transpose()));
  const Mat6 repaired = solver.eigenvectors() * solver.eigenvalues().cwiseMax(1.0).asDiagonal() *
                        solver.eigenvectors().transpose();
  return least.asDiagonal() * repaired * least.asDiagonal();
}

std::vector<CloudPair> inAndOutCandidates(const std::vector<MapKeyframe>& keyframes,
                                          const InAndOutOptions& options) {
  options.check();
  const std::vector<double> paths = pathsOf(keyframes);
  const double spacing_m =
      paths.empty() ? options.spacing_m : std::max(options.spacing_m, paths.back() / options.most_pairs);
  std::vector<CloudPair> pairs;
  double next_m = 0.0;
  for (size_t later = 0; later < keyframes.size(); ++later) {
    if (paths[later] < next_m || static_cast<int>(pairs.size()) >= options.most_pairs) continue;
    const auto pair = pairOf(keyframes, paths, later, options);
    if (!pair) continue;
    pairs.push_back(*pair);
    next_m = paths[later] + spacing_m;
  }
  std::stable_sort(pairs.begin(), pairs.end(), [](const CloudPair& a, const CloudPair& b) {
    return uncertaintyOf(a) < uncertaintyOf(b);
  });
  return pairs;
}

}  // namespace lodeline
