#include "lodeline/mapping/graph/graph_covariance.h"

#include <fmt/format.h>

#include "lodeline/diagnostics.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/graph/graph_factorization.h"

namespace lodeline {

const GraphCovariance::Factorization::Place& GraphCovariance::Factorization::of(KeyframeId node) const {
  const auto found = nodes.find(node);
  if (found == nodes.end()) throw InputError(fmt::format("node {} is not in the graph", node));
  return found->second;
}

GraphCovariance::GraphCovariance(std::shared_ptr<const Factorization> factorization)
    : factorization_(std::move(factorization)) {}

Mat6 GraphCovariance::of(KeyframeId node) const { return joint({node}); }

Eigen::MatrixXd GraphCovariance::joint(const std::vector<KeyframeId>& nodes) const {
  // Row of the normal matrix for each of the 6 perturbations of each node, -1 where it is held.
  std::vector<int> rows;
  for (const KeyframeId id : nodes) {
    const Factorization::Place& place = factorization_->of(id);
    std::vector<int> of_node(6, -1);
    for (size_t i = 0; i < place.free_axes.size(); ++i) {
      of_node[static_cast<size_t>(place.free_axes[i])] = place.first_column + static_cast<int>(i);
    }
    rows.insert(rows.end(), of_node.begin(), of_node.end());
  }
  const int size = static_cast<int>(rows.size());
  Eigen::MatrixXd units = Eigen::MatrixXd::Zero(factorization_->normal.cols(), size);
  for (int i = 0; i < size; ++i) {
    if (rows[static_cast<size_t>(i)] >= 0) units(rows[static_cast<size_t>(i)], i) = 1.0;
  }
  const Eigen::MatrixXd columns = factorization_->normal.solve(units);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(size, size);
  for (int i = 0; i < size; ++i) {
    if (rows[static_cast<size_t>(i)] >= 0) covariance.row(i) = columns.row(rows[static_cast<size_t>(i)]);
  }
  return 0.5 * (covariance + covariance.transpose());
}

RelativePose GraphCovariance::relative(KeyframeId from, KeyframeId to) const {
  const Rigid3& world_from_from = factorization_->of(from).world_from_body;
  const Rigid3& world_from_to = factorization_->of(to).world_from_body;
  const Mat3 body_from_world = world_from_from.rotation.conjugate().toRotationMatrix();
  const Vec3 way_W = world_from_to.translation - world_from_from.translation;
  // Error in axes of `from`: R^T (e_to - A e_from), see odometryEdge().
  Eigen::Matrix<double, 6, 12> derivative = Eigen::Matrix<double, 6, 12>::Zero();
  derivative.block<3, 3>(0, 0) = -body_from_world;
  derivative.block<3, 3>(0, 3) = body_from_world * so3::skew(way_W);
  derivative.block<3, 3>(3, 3) = -body_from_world;
  derivative.block<3, 3>(0, 6) = body_from_world;
  derivative.block<3, 3>(3, 9) = body_from_world;
  return {world_from_from.inverse() * world_from_to, derivative * joint({from, to}) * derivative.transpose()};
}

}  // namespace lodeline
