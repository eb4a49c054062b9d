#include "lodeline/mapping/graph/graph_gauge.h"

#include <algorithm>

#include "lodeline/mapping/graph/graph_problem.h"

namespace lodeline {
namespace {

/// Two measured positions that are this far apart determine an azimuth.
constexpr double kLeastBase_m = 1.0;

}  // namespace

bool HeldPoseManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  Eigen::Matrix<double, 6, 1> perturbation = Eigen::Matrix<double, 6, 1>::Zero();
  for (size_t i = 0; i < free_axes_.size(); ++i) perturbation[free_axes_[i]] = delta[i];
  return PoseManifold().Plus(x, perturbation.data(), x_plus_delta);
}

bool HeldPoseManifold::PlusJacobian(const double*, double* jacobian) const {
  const size_t columns = free_axes_.size();
  std::fill_n(jacobian, kPoseSize * columns, 0.0);
  for (size_t i = 0; i < columns; ++i) jacobian[static_cast<size_t>(free_axes_[i]) * columns + i] = 1.0;
  return true;
}

bool HeldPoseManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  Eigen::Matrix<double, 6, 1> difference;
  PoseManifold().Minus(y, x, difference.data());
  for (size_t i = 0; i < free_axes_.size(); ++i) y_minus_x[i] = difference[free_axes_[i]];
  return true;
}

bool HeldPoseManifold::MinusJacobian(const double*, double* jacobian) const {
  std::fill_n(jacobian, kPoseSize * free_axes_.size(), 0.0);
  for (size_t i = 0; i < free_axes_.size(); ++i) {
    jacobian[i * kPoseSize + static_cast<size_t>(free_axes_[i])] = 1.0;
  }
  return true;
}

KeyframeId GraphProblem::partOf(KeyframeId id) {
  KeyframeId first = id;
  while (nodes_.at(first).part != first) first = nodes_.at(first).part;
  for (KeyframeId next = id; next != first;) {  // shortens the way for later questions
    KeyframeId& part = nodes_.at(next).part;
    next = part;
    part = first;
  }
  return first;
}

void GraphProblem::join(KeyframeId a, KeyframeId b) {
  const KeyframeId first_a = partOf(a), first_b = partOf(b);
  nodes_.at(std::max(first_a, first_b)).part = std::min(first_a, first_b);
}

void GraphProblem::addMeasuredPosition(const Vec3& position_W) {
  const auto is_near = [&](const Vec3& other_W) {
    return (other_W - position_W).head<2>().norm() < kLeastBase_m;
  };
  if (measured_positions_W_.size() < 2 &&
      std::none_of(measured_positions_W_.begin(), measured_positions_W_.end(), is_near)) {
    measured_positions_W_.push_back(position_W);
  }
}

std::vector<int> GraphProblem::openAxes() const {
  const bool has_azimuth = std::any_of(azimuths_.begin(), azimuths_.end(),
                                       [](const auto& entry) { return entry.second.is_measured; });
  const bool has_position = !measured_positions_W_.empty();
  std::vector<int> open;
  if (!has_position) open = {0, 1};
  if (!has_position && !surface_.is_measured) open.push_back(2);
  if (!has_tilt_) open.insert(open.end(), {3, 4});
  if (measured_positions_W_.size() < 2 && !has_azimuth) open.push_back(5);
  return open;
}

void GraphProblem::hold() {
  for (auto& [id, state] : nodes_) {
    if (partOf(id) != id || state.weak) continue;
    state.weak = std::make_unique<Prior>();
    Vec6 sigmas;
    sigmas << Vec3::Constant(kWeakPosition_m), Vec3::Constant(kWeakRotation_rad);
    state.weak->append(state.pose.data(), kPoseSize, sigmas);
    addCertain(std::make_unique<PriorFactor>(*state.weak), {state.pose.data()});
  }
  if (nodes_.empty()) return;
  if (held_ < 0) held_ = nodes_.begin()->first;
  Node& first = nodes_.at(held_);
  const std::vector<int> open = openAxes();
  std::vector<int> free_axes;
  for (int axis = 0; axis < kPoseTangentSize; ++axis) {
    if (std::find(open.begin(), open.end(), axis) == open.end()) free_axes.push_back(axis);
  }
  if (free_axes == first.free_axes) return;
  first.free_axes = free_axes;
  if (free_axes.empty()) {
    problem_->SetParameterBlockConstant(first.pose.data());
    return;
  }
  problem_->SetParameterBlockVariable(first.pose.data());
  manifolds_.push_back(std::make_unique<HeldPoseManifold>(free_axes));
  problem_->SetManifold(first.pose.data(), manifolds_.back().get());
}

}  // namespace lodeline
