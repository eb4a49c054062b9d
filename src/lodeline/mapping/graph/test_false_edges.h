#pragma once

#include <random>
#include <vector>

#include "lodeline/mapping/graph/test_g2o.h"

namespace lodeline {

/// False loops between nodes of a chain at least 10 apart, drawn uniformly, with relative poses like those of
/// true loops: within 10 m, any azimuth. Runs of `run` loops between consecutive nodes agree with each other
/// within their covariance through the odometry.
std::vector<GraphEdge> falseEdges(const G2oGraph& graph, size_t count, int run, const Mat6& covariance,
                                  std::mt19937_64* generator);

/// RMS of the distances between the positions of two solutions with the same held node, m.
double rmsDistance_m(const std::map<KeyframeId, Rigid3>& a, const std::map<KeyframeId, Rigid3>& b);

}  // namespace lodeline
