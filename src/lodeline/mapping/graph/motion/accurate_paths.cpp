#include "lodeline/mapping/graph/motion/accurate_paths.h"

#include <limits>
#include <queue>
#include <utility>

namespace lodeline {
namespace {

constexpr double kLeverArm_m = 10.0;

double costOf(const Mat6& covariance) {
  return covariance.topLeftCorner<3, 3>().trace() +
         kLeverArm_m * kLeverArm_m * covariance.bottomRightCorner<3, 3>().trace();
}

}  // namespace

size_t AccuratePaths::place(KeyframeId id) {
  const auto [found, is_new] = index_.try_emplace(id, ways_.size());
  if (is_new) ways_.emplace_back();
  return found->second;
}

void AccuratePaths::add(KeyframeId from, KeyframeId to, const RelativePose& relative) {
  const size_t first = place(from), second = place(to);
  const double cost = costOf(relative.covariance);
  ways_[first].push_back({second, cost, relative});
  ways_[second].push_back({first, cost, inverted(relative)});
}

std::map<KeyframeId, Mat6> AccuratePaths::from(KeyframeId from,
                                               const std::vector<KeyframeId>& targets) const {
  std::map<KeyframeId, Mat6> covariances;
  const auto start = index_.find(from);
  if (start == index_.end()) return covariances;
  std::map<size_t, KeyframeId> wanted;
  for (const KeyframeId target : targets) {
    const auto found = index_.find(target);
    if (found != index_.end()) wanted.emplace(found->second, target);
  }
  struct Arrival {
    size_t before = 0;
    const Way* by = nullptr;
    double cost = std::numeric_limits<double>::infinity();
    RelativePose relative;
    bool is_settled = false;
  };
  std::vector<Arrival> arrivals(ways_.size());
  using Step = std::pair<double, size_t>;
  std::priority_queue<Step, std::vector<Step>, std::greater<>> open;
  arrivals[start->second].cost = 0.0;
  open.emplace(0.0, start->second);
  while (!open.empty() && !wanted.empty()) {
    const size_t next = open.top().second;
    open.pop();
    Arrival& arrival = arrivals[next];
    if (arrival.is_settled) continue;
    arrival.is_settled = true;
    if (arrival.by) arrival.relative = composed(arrivals[arrival.before].relative, arrival.by->relative);
    const auto found = wanted.find(next);
    if (found != wanted.end()) {
      covariances.emplace(found->second, arrival.relative.covariance);
      wanted.erase(found);
    }
    for (const Way& way : ways_[next]) {
      const double cost = arrival.cost + way.cost;
      if (cost >= arrivals[way.to].cost) continue;
      arrivals[way.to].cost = cost;
      arrivals[way.to].before = next;
      arrivals[way.to].by = &way;
      open.emplace(cost, way.to);
    }
  }
  return covariances;
}

}  // namespace lodeline
