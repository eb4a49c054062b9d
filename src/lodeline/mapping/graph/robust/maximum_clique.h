#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace lodeline {

/// Undirected graph on the vertices 0 to size - 1, as rows of bits.
class AdjacencyMatrix {
 public:
  explicit AdjacencyMatrix(size_t size);

  size_t size() const { return size_; }
  void connect(size_t a, size_t b);
  bool areConnected(size_t a, size_t b) const { return (rows_[a][b / 64] >> (b % 64)) & 1U; }
  const std::vector<uint64_t>& row(size_t vertex) const { return rows_[vertex]; }

 private:
  size_t size_;
  std::vector<std::vector<uint64_t>> rows_;
};

struct Clique {
  std::vector<size_t> vertices;  ///< ascending
  bool is_largest = true;        ///< proved; false where the search ended at `most_steps`
};

/// A largest set of vertices that are all connected with each other. Branch and bound with greedy colouring
/// and bit sets: P. San Segundo, D. Rodríguez-Losada, A. Jiménez, "An exact bit-parallel algorithm for the
/// maximum clique problem", Computers & Operations Research, 2011. The result is the same for the same graph.
/// `most_steps`: branches after which the largest clique found so far is returned.
Clique maximumClique(const AdjacencyMatrix& graph, size_t most_steps = 5'000'000);

}  // namespace lodeline
