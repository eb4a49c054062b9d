#pragma once

#include <cstddef>
#include <vector>

namespace lodeline {

/// Groups of states that one term of the batch problem connects, as indices of states.
using StateCliques = std::vector<std::vector<size_t>>;

/// The states that share a clique with each state, ascending and without itself.
std::vector<std::vector<size_t>> neighboursOf(size_t states, const StateCliques& cliques);

/// Number of states between the first neighbour of each state and itself, summed over a skyline with the
/// states in this order. `order`: the states, first row first.
size_t envelopeOf(const std::vector<std::vector<size_t>>& neighbours, const std::vector<size_t>& order);

/// Order of the states for the skyline of a recording with loops: that of time, or reverse Cuthill-McKee
/// where its envelope is smaller. In order of time the rows of a second pass reach back to the first one. The
/// other order follows the way through the cave, with all passes side by side. (E. Cuthill, J. McKee,
/// "Reducing the bandwidth of sparse symmetric matrices", 1969; A. George, J. Liu, 1981, chapter 4.)
std::vector<size_t> narrowOrder(const std::vector<std::vector<size_t>>& neighbours);

}  // namespace lodeline
