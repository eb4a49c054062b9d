#include "lodeline/mapping/graph/robust/loop_support.h"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <utility>

namespace lodeline {
namespace {

/// Keyframes up to which loops are neighbours. Odometry between them tells true from false.
constexpr int kWindow = 25;

/// Sigma of the position that a circuit may have, relative to that of its loops. Where odometry is less
/// accurate, agreement tells little.
constexpr double kMostWidening = 8.0;

struct Ends {
  OdometryChains::Place old_end, new_end;
};

/// Whether both single, or near each other in one chain.
bool areNear(const OdometryChains::Place& a, const OdometryChains::Place& b) {
  return a.chain == b.chain && std::abs(a.number - b.number) <= kWindow;
}

/// Whether the odometry in a circuit is accurate enough to compare its loops.
bool isTight(const Circuit& circuit, const Loop& a, const Loop& b) {
  const double own_variance = (a.covariance + b.covariance).topLeftCorner<3, 3>().trace();
  const double variance = circuit.covariance.topLeftCorner<3, 3>().trace();
  return variance <= kMostWidening * kMostWidening * own_variance;
}

/// The loop from the end that is first along the chains.
Loop directed(const Loop& loop, const OdometryChains& chains) {
  if (chains.of(loop.old_keyframe) <= chains.of(loop.new_keyframe)) return loop;
  const RelativePose back = inverted({loop.old_from_new, loop.covariance});
  Loop result;
  result.old_keyframe = loop.new_keyframe;
  result.new_keyframe = loop.old_keyframe;
  result.old_from_new = back.from_from_to;
  result.covariance = back.covariance;
  return result;
}

}  // namespace

AccidentalAgreement::AccidentalAgreement(std::vector<std::ptrdiff_t> counts_of_refused)
    : counts_(std::move(counts_of_refused)) {
  std::sort(counts_.begin(), counts_.end());
}

double AccidentalAgreement::share(std::ptrdiff_t count) const {
  if (counts_.empty()) return 0.0;
  const auto first = std::lower_bound(counts_.begin(), counts_.end(), count);
  return static_cast<double>(counts_.end() - first) / static_cast<double>(counts_.size());
}

std::vector<LoopPair> neighbouringLoops(const std::vector<Loop>& loops, size_t first_new,
                                        const OdometryChains& chains, const OdometryBetween& between_singles,
                                        double limit) {
  std::vector<Loop> forward;
  std::vector<Ends> ends;
  for (const Loop& loop : loops) {
    forward.push_back(directed(loop, chains));
    ends.push_back({chains.of(forward.back().old_keyframe), chains.of(forward.back().new_keyframe)});
  }
  std::vector<size_t> order(loops.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return ends[a].new_end < ends[b].new_end; });
  const OdometryBetween between = [&](KeyframeId from, KeyframeId to) -> RelativePose {
    if (from == to) return {};
    return chains.of(from).chain >= 0 ? chains.relative(from, to) : between_singles(from, to);
  };
  std::vector<LoopPair> pairs;
  for (size_t i = 0; i < order.size(); ++i) {
    const size_t a = order[i];
    for (size_t j = i + 1; j < order.size() && areNear(ends[a].new_end, ends[order[j]].new_end); ++j) {
      const size_t b = order[j];
      if (std::max(a, b) < first_new || !areNear(ends[a].old_end, ends[b].old_end)) continue;
      const Circuit circuit = circuitOf(forward[a], forward[b], between);
      if (isTight(circuit, forward[a], forward[b])) pairs.push_back({a, b, circuit.chiSquared() <= limit});
    }
  }
  return pairs;
}

}  // namespace lodeline
