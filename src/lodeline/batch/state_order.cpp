#include "lodeline/batch/state_order.h"

#include <algorithm>
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/cuthill_mckee_ordering.hpp>
#include <boost/graph/properties.hpp>
#include <numeric>

namespace lodeline {
namespace {

using OrderedGraph = boost::adjacency_list<boost::vecS, boost::vecS, boost::undirectedS,
                                           boost::property<boost::vertex_color_t, boost::default_color_type>>;

std::vector<size_t> reverseCuthillMcKee(const std::vector<std::vector<size_t>>& neighbours) {
  OrderedGraph graph(neighbours.size());
  for (size_t k = 0; k < neighbours.size(); ++k) {
    for (const size_t other : neighbours[k]) {
      if (other < k) boost::add_edge(k, other, graph);
    }
  }
  std::vector<size_t> order(neighbours.size());
  boost::cuthill_mckee_ordering(graph, order.rbegin(), boost::get(boost::vertex_color, graph),
                                boost::make_degree_map(graph));
  return order;
}

}  // namespace

std::vector<std::vector<size_t>> neighboursOf(size_t states, const StateCliques& cliques) {
  std::vector<std::vector<size_t>> cliques_of(states);
  for (size_t i = 0; i < cliques.size(); ++i) {
    for (const size_t k : cliques[i]) cliques_of[k].push_back(i);
  }
  std::vector<std::vector<size_t>> neighbours(states);
  std::vector<size_t> seen_by(states, states);
  for (size_t k = 0; k < states; ++k) {
    seen_by[k] = k;
    for (const size_t i : cliques_of[k]) {
      for (const size_t other : cliques[i]) {
        if (seen_by[other] == k) continue;
        seen_by[other] = k;
        neighbours[k].push_back(other);
      }
    }
    std::sort(neighbours[k].begin(), neighbours[k].end());
  }
  return neighbours;
}

size_t envelopeOf(const std::vector<std::vector<size_t>>& neighbours, const std::vector<size_t>& order) {
  std::vector<size_t> place(order.size());
  for (size_t i = 0; i < order.size(); ++i) place[order[i]] = i;
  size_t sum = 0;
  for (size_t k = 0; k < order.size(); ++k) {
    size_t first = place[k];
    for (const size_t other : neighbours[k]) first = std::min(first, place[other]);
    sum += place[k] - first;
  }
  return sum;
}

std::vector<size_t> narrowOrder(const std::vector<std::vector<size_t>>& neighbours) {
  std::vector<size_t> by_time(neighbours.size());
  std::iota(by_time.begin(), by_time.end(), size_t{0});
  std::vector<size_t> reordered = reverseCuthillMcKee(neighbours);
  return envelopeOf(neighbours, reordered) < envelopeOf(neighbours, by_time) ? reordered : by_time;
}

}  // namespace lodeline
