#pragma once

#include <filesystem>
#include <map>
#include <vector>

#include "lodeline/mapping/graph/graph_elements.h"

namespace lodeline {

/// A pose graph of a g2o file: VERTEX_SE3:QUAT and EDGE_SE3:QUAT.
struct G2oGraph {
  std::map<KeyframeId, Rigid3> nodes;  ///< world_from_body
  std::vector<GraphEdge> edges;        ///< robust where they do not connect neighbours
};

/// Reads a g2o file. An edge has the information matrix of [dp, dq] in the axes of `to`. dq is the vector
/// part of the error's quaternion, half of its angle. The matrix becomes the covariance of [dp, dtheta] in
/// axes of `from`. Throws InputError that names the line.
G2oGraph readG2o(const std::filesystem::path& file);

}  // namespace lodeline
