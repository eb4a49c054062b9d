// Order of the blocks of a BatchProblem and the skyline of its matrix.
#include <algorithm>
#include <numeric>

#include "lodeline/batch/batch_problem.h"

namespace lodeline {

void BatchProblem::appendBlock(double* value, int tangent_size, int first) {
  const int row = static_cast<int>(sizes_.size());
  rows_[value] = row;
  sizes_.push_back(tangent_size);
  first_.push_back(std::min(first, row));
}

StateCliques BatchProblem::cliques() const {
  StateCliques cliques;
  for (size_t k = 1; k < states(); ++k) cliques.push_back({k - 1, k});
  for (const auto& [id, track] : window_.tracks()) {
    std::vector<size_t>& clique = cliques.emplace_back();
    for (const Observation& observation : track.observations) {
      const auto k = static_cast<size_t>(observation.frame);
      if (clique.empty() || clique.back() != k) clique.push_back(k);
    }
  }
  return cliques;
}

std::vector<std::vector<size_t>> BatchProblem::neighbours() const {
  StateCliques cliques = this->cliques();
  std::vector<std::vector<size_t>> neighbours = neighboursOf(states(), cliques);
  // A measurement on landmarks connects all earlier states that share a landmark with its own.
  const size_t without = cliques.size();
  for (size_t k = 0; k < states(); ++k) {
    const Measurements& measurements = window_.frames()[k]->measurements;
    if (std::none_of(measurements.begin(), measurements.end(),
                     [](const auto& measurement) { return measurement->containsLandmarks(); }))
      continue;
    std::vector<size_t>& clique = cliques.emplace_back();
    for (const size_t other : neighbours[k]) {
      if (other < k) clique.push_back(other);
    }
    clique.push_back(k);
    if (!links_.empty()) continue;
    clique.resize(k - clique.front() + 1);
    std::iota(clique.begin(), clique.end(), k + 1 - clique.size());
  }
  return cliques.size() > without ? neighboursOf(states(), cliques) : neighbours;
}

size_t BatchProblem::endOf(const Chain& chain, size_t node) const {
  return node + 1 < chain.size() ? chain[node + 1].first : states();
}

void BatchProblem::orderBlocks() {
  rows_.clear();
  sizes_.clear();
  first_.clear();
  const std::vector<std::vector<size_t>> neighbours = this->neighbours();
  std::vector<size_t> order(states());
  std::iota(order.begin(), order.end(), size_t{0});
  // Without loops, the order of time has the narrowest skyline.
  if (joined_.links_used > 0) order = narrowOrder(neighbours);
  std::vector<size_t> place(states());
  for (size_t i = 0; i < order.size(); ++i) place[order[i]] = i;
  const auto poseRow = [&](size_t k) { return rowOf(state(k).pose.data()); };
  // A node of a chain comes after the states for which it is valid. The start's prior correlates the first
  // node with the first state.
  const auto appendNodes = [&](const Chain& chain, size_t k) {
    for (size_t i = 0; i < chain.size(); ++i) {
      int first = static_cast<int>(sizes_.size());
      size_t last_place = 0;
      if (k < chain[i].first || k >= endOf(chain, i)) continue;
      for (size_t j = chain[i].first; j < endOf(chain, i); ++j) last_place = std::max(last_place, place[j]);
      if (last_place != place[k]) continue;
      for (size_t j = chain[i].first; j < endOf(chain, i); ++j) first = std::min(first, poseRow(j));
      for (const size_t j : {i - 1, i + 1}) {
        const auto row = j < chain.size() ? rows_.find(chain[j].state->value.data()) : rows_.end();
        if (row != rows_.end()) first = std::min(first, row->second);
      }
      appendBlock(chain[i].state->value.data(), chain[i].state->tangentSize(), first);
    }
  };
  for (const size_t k : order) {
    Frame& frame = *window_.frames()[k];
    int first = static_cast<int>(sizes_.size()), first_of_motion = first;
    for (const size_t other : neighbours[k]) {
      if (place[other] > place[k]) continue;
      first = std::min(first, poseRow(other));
      const bool is_next = other + 1 == k || other == k + 1;  // by inertial readings
      if (is_next) first_of_motion = std::min(first_of_motion, poseRow(other));
    }
    appendBlock(frame.pose.data(), kPoseTangentSize, first);
    appendBlock(frame.motion.data(), kMotionSize, first_of_motion);
    for (const Chain& chain : chains_) appendNodes(chain, k);
  }
  for (const auto& global : window_.globals()) {
    if (rows_.count(global->value.data()) == 0) appendBlock(global->value.data(), global->tangentSize(), 0);
  }
}

}  // namespace lodeline
