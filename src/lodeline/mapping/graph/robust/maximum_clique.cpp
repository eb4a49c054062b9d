#include "lodeline/mapping/graph/robust/maximum_clique.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

using Bits = std::vector<uint64_t>;

bool isEmpty(const Bits& bits) {
  return std::all_of(bits.begin(), bits.end(), [](uint64_t word) { return word == 0; });
}

size_t firstOf(const Bits& bits) {
  size_t word = 0;
  while (bits[word] == 0) ++word;
  return 64 * word + static_cast<size_t>(std::countr_zero(bits[word]));
}

void clear(size_t bit, Bits* bits) { (*bits)[bit / 64] &= ~(uint64_t{1} << (bit % 64)); }

/// Depth-first search over the vertices in an order of falling degree, which makes colours few.
class CliqueSearch {
 public:
  CliqueSearch(const AdjacencyMatrix& graph, size_t most_steps)
      : steps_left_(most_steps), order_(byDegree(graph)), ordered_(graph.size()) {
    for (size_t a = 0; a < graph.size(); ++a) {
      for (size_t b = 0; b < a; ++b) {
        if (graph.areConnected(order_[a], order_[b])) ordered_.connect(a, b);
      }
    }
  }

  Clique run() {
    Bits all((order_.size() + 63) / 64, 0);
    for (size_t i = 0; i < order_.size(); ++i) all[i / 64] |= uint64_t{1} << (i % 64);
    const bool is_complete = expand(all);
    Clique clique{{}, is_complete};
    for (const size_t vertex : best_) clique.vertices.push_back(order_[vertex]);
    std::sort(clique.vertices.begin(), clique.vertices.end());
    return clique;
  }

 private:
  static std::vector<size_t> byDegree(const AdjacencyMatrix& graph) {
    std::vector<int> degree(graph.size(), 0);
    for (size_t i = 0; i < graph.size(); ++i) {
      for (const uint64_t word : graph.row(i)) degree[i] += std::popcount(word);
    }
    std::vector<size_t> order(graph.size());
    std::iota(order.begin(), order.end(), size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return degree[a] > degree[b]; });
    return order;
  }

  /// Colours the candidates greedily: no two of one colour are connected, so a clique has at most one of
  /// each. Vertices and colours come in the order of rising colours.
  void colour(Bits uncoloured, std::vector<size_t>* vertices, std::vector<size_t>* colours) const {
    for (size_t number = 1; !isEmpty(uncoloured); ++number) {
      Bits candidates = uncoloured;
      while (!isEmpty(candidates)) {
        const size_t vertex = firstOf(candidates);
        clear(vertex, &candidates);
        clear(vertex, &uncoloured);
        for (size_t w = 0; w < candidates.size(); ++w) candidates[w] &= ~ordered_.row(vertex)[w];
        vertices->push_back(vertex);
        colours->push_back(number);
      }
    }
  }

  /// Extends the present clique by all candidates in turn. False where the steps ran out.
  bool expand(Bits candidates) {
    std::vector<size_t> vertices, colours;
    colour(candidates, &vertices, &colours);
    for (size_t i = vertices.size(); i-- > 0;) {
      if (present_.size() + colours[i] <= best_.size()) return true;
      if (steps_left_ == 0) return false;
      --steps_left_;
      const size_t vertex = vertices[i];
      present_.push_back(vertex);
      if (present_.size() > best_.size()) best_ = present_;
      Bits narrowed = candidates;
      for (size_t w = 0; w < narrowed.size(); ++w) narrowed[w] &= ordered_.row(vertex)[w];
      if (!isEmpty(narrowed) && !expand(std::move(narrowed))) return false;
      present_.pop_back();
      clear(vertex, &candidates);
    }
    return true;
  }

  size_t steps_left_;
  std::vector<size_t> order_;  ///< vertex of the graph for each vertex of the search
  AdjacencyMatrix ordered_;
  std::vector<size_t> present_, best_;
};

}  // namespace

AdjacencyMatrix::AdjacencyMatrix(size_t size)
    : size_(size), rows_(size, std::vector<uint64_t>((size + 63) / 64, 0)) {}

void AdjacencyMatrix::connect(size_t a, size_t b) {
  if (a >= size_ || b >= size_) throw InputError("a vertex lies outside the graph");
  if (a == b) return;
  rows_[a][b / 64] |= uint64_t{1} << (b % 64);
  rows_[b][a / 64] |= uint64_t{1} << (a % 64);
}

Clique maximumClique(const AdjacencyMatrix& graph, size_t most_steps) {
  return CliqueSearch(graph, most_steps).run();
}

}  // namespace lodeline
