#include "lodeline/mapping/graph/test_false_edges.h"

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "lodeline/geometry/so3.h"
#include "lodeline/mapping/graph/motion/odometry_chain.h"
#include "lodeline/mapping/graph/test_graphs.h"

namespace lodeline {

std::vector<GraphEdge> falseEdges(const G2oGraph& graph, size_t count, int run, const Mat6& covariance,
                                  std::mt19937_64* generator) {
  OdometryChain odometry;
  odometry.start(graph.nodes.begin()->first, Rigid3{});
  for (const GraphEdge& edge : graph.edges) {
    if (!edge.robust) odometry.extend(edge.to, edge.relative);
  }
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::uniform_int_distribution<KeyframeId> any(0, static_cast<KeyframeId>(graph.nodes.size()) - run);
  std::vector<GraphEdge> edges;
  while (edges.size() < count) {
    const KeyframeId from = any(*generator), to = any(*generator);
    if (std::abs(from - to) < 10) continue;
    const Vec3 position(10.0 * uniform(*generator), 10.0 * uniform(*generator), uniform(*generator));
    const Rigid3 first(so3::exp(std::numbers::pi * uniform(*generator) * Vec3::UnitZ()), position);
    for (int k = 0; k < run && edges.size() < count; ++k) {
      const Rigid3 relative = odometry.relative(from, from + k).from_from_to.inverse() * first *
                              odometry.relative(to, to + k).from_from_to;
      edges.push_back({from + k, to + k, withError({relative, covariance}, generator), true});
    }
  }
  return edges;
}

double rmsDistance_m(const std::map<KeyframeId, Rigid3>& a, const std::map<KeyframeId, Rigid3>& b) {
  double sum = 0.0;
  for (const auto& [id, pose] : a) sum += (pose.translation - b.at(id).translation).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

}  // namespace lodeline
