#pragma once

#include <Eigen/SparseCholesky>
#include <map>
#include <vector>

#include "lodeline/mapping/graph/graph_covariance.h"

namespace lodeline {

/// Cholesky factorization of the normal matrix J^T J of a graph.
struct GraphCovariance::Factorization {
  /// Columns of a node: one for each free perturbation.
  struct Place {
    int first_column = 0;
    std::vector<int> free_axes;  ///< of [dp, dtheta], ascending; empty for a node that is held
    Rigid3 world_from_body;
  };
  std::map<KeyframeId, Place> nodes;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> normal;

  const Place& of(KeyframeId node) const;
};

}  // namespace lodeline
