#pragma once

#include "lodeline/mapping/graph/motion/odometry_chain.h"

namespace lodeline {

/// The chains that the certain edges of a graph form. An edge extends a chain where it leads from its newest
/// node to one that has no other; further edges are left out. A node without such an edge is single.
class OdometryChains {
 public:
  struct Place {
    int chain = -1;  ///< -1: single
    int number = 0;  ///< along the chain, 0 for the first node
    auto operator<=>(const Place&) const = default;
  };

  void add(KeyframeId from, KeyframeId to, const RelativePose& from_from_to);
  Place of(KeyframeId id) const;
  /// Of two nodes of one chain.
  RelativePose relative(KeyframeId from, KeyframeId to) const;
  /// Chains, each with its nodes in order.
  const std::vector<std::vector<KeyframeId>>& nodes() const { return nodes_; }

 private:
  std::map<KeyframeId, Place> places_;
  std::vector<std::vector<KeyframeId>> nodes_;
  std::vector<OdometryChain> chains_;
};

}  // namespace lodeline
