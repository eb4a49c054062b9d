#include "lodeline/frontend/stereo/stereo_delay.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

constexpr size_t kEquationsOfFrame = 30, kMostEquations = 6000;
constexpr int kLeastFrames = 30, kDelayIterations = 8;
constexpr double kEvenError_px = 0.2;  // below which errors weigh alike
constexpr double kNoMatch_px = 20.0;   // no match at all
constexpr double kTurnSigma_rad = 1.0 * kDegree, kDelaySigma_s = 0.1;
constexpr double kNearest_m = 0.2;

using Unknowns = Eigen::Vector4d;

}  // namespace

void StereoDelay::add(const std::vector<RayPair>& pairs, const Rigid3& second_from_first, double focal_px,
                      const Vec3& rate_C, const Vec3& velocity_C) {
  ++frames_;
  const size_t every = std::max<size_t>(1, pairs.size() / kEquationsOfFrame);
  for (size_t i = 0; i < pairs.size(); i += every) {
    const Rigid3 between = pairs[i].betweenOrigins(second_from_first);
    const std::optional<Vec3> normal = epipolarNormal(between, pairs[i].first);
    if (!normal) continue;
    const Vec3& ray = pairs[i].second;
    const double error_px = focal_px * normal->dot(ray);
    if (std::abs(error_px) > kNoMatch_px) continue;
    // Solves ray x (R first + rho t) = 0 by least squares.
    const Vec3 a = ray.cross(between.translation);
    const Vec3 b = ray.cross(between.rotation * pairs[i].first);
    const double rho_per_m = std::clamp(-a.dot(b) / std::max(a.squaredNorm(), 1e-12), 0.0, 1.0 / kNearest_m);
    const Vec3 by_turn = focal_px * ray.cross(*normal);
    const double by_delay = -by_turn.dot(rate_C) - focal_px * rho_per_m * normal->dot(velocity_C);
    newest_.push_back({error_px, by_turn, by_delay, frames_});
  }
  while (newest_.size() > kMostEquations) newest_.pop_front();
}

std::optional<StereoDelay::Estimate> StereoDelay::estimate() const {
  if (newest_.empty() || newest_.back().frame - newest_.front().frame < kLeastFrames) return std::nullopt;
  Unknowns unknowns = Unknowns::Zero();
  const auto row = [](const Equation& equation) {
    return Unknowns(equation.by_turn.x(), equation.by_turn.y(), equation.by_turn.z(), equation.by_delay);
  };
  Eigen::Matrix4d information;
  for (int i = 0; i < kDelayIterations; ++i) {
    information = Unknowns(1.0, 1.0, 1.0, 0.0).asDiagonal();
    information /= kTurnSigma_rad * kTurnSigma_rad;
    information(3, 3) = 1.0 / (kDelaySigma_s * kDelaySigma_s);
    Unknowns right_side = Unknowns::Zero();
    for (const Equation& equation : newest_) {
      const Unknowns slope = row(equation);
      const double weight = 1.0 / std::max(std::abs(equation.error_px - slope.dot(unknowns)), kEvenError_px);
      information += weight * slope * slope.transpose();
      right_side += weight * equation.error_px * slope;
    }
    unknowns = information.ldlt().solve(right_side);
  }
  // Errors of matches in the same or neighbouring frames are correlated: the scatter is that of sums over
  // blocks of frames.
  constexpr int kFramesOfBlock = 10;
  std::map<int, Unknowns> sums;
  for (const Equation& equation : newest_) {
    const Unknowns slope = row(equation);
    const double error = equation.error_px - slope.dot(unknowns);
    Unknowns& sum = sums.try_emplace(equation.frame / kFramesOfBlock, Unknowns::Zero()).first->second;
    sum += error / std::max(std::abs(error), kEvenError_px) * slope;
  }
  Eigen::Matrix4d scatter = Eigen::Matrix4d::Zero();
  for (const auto& [block, sum] : sums) scatter += sum * sum.transpose();
  const Eigen::Matrix4d inverse = information.inverse();
  const Eigen::Matrix4d covariance = inverse * (information + scatter) * inverse;
  return Estimate{unknowns[3], std::sqrt(covariance(3, 3))};
}

}  // namespace lodeline
