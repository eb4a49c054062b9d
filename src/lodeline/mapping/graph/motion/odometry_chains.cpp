#include "lodeline/mapping/graph/motion/odometry_chains.h"

namespace lodeline {

void OdometryChains::add(KeyframeId from, KeyframeId to, const RelativePose& from_from_to) {
  if (places_.count(to) > 0) return;
  const auto found = places_.find(from);
  if (found == places_.end()) {
    places_[from] = {static_cast<int>(chains_.size()), 0};
    chains_.emplace_back().start(from, Rigid3{});
    nodes_.push_back({from});
  }
  const auto chain = static_cast<size_t>(places_.at(from).chain);
  if (nodes_[chain].back() != from) return;
  places_[to] = {static_cast<int>(chain), static_cast<int>(nodes_[chain].size())};
  chains_[chain].extend(to, from_from_to);
  nodes_[chain].push_back(to);
}

OdometryChains::Place OdometryChains::of(KeyframeId id) const {
  const auto found = places_.find(id);
  return found == places_.end() ? Place{} : found->second;
}

RelativePose OdometryChains::relative(KeyframeId from, KeyframeId to) const {
  return chains_.at(static_cast<size_t>(of(from).chain)).relative(from, to);
}

}  // namespace lodeline
