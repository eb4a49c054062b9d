#include "lodeline/output/survey/map/loop_candidates.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "lodeline/trajectory.h"

namespace lodeline {
namespace {

/// A station that returns to a leg.
struct Revisit {
  size_t station = 0, leg = 0;
  Vec3 offset_ENU = Vec3::Zero(), sigma_ENU = Vec3::Zero();
  double length_m = 0.0;
};

class LineSearch {
 public:
  LineSearch(const Survey& survey, const LoopOptions& options) : survey_(survey), options_(options) {
    way_m_.push_back(0.0);
    for (size_t i = 1; i < survey.stations.size(); ++i) way_m_.push_back(way_m_.back() + leg(i - 1).norm());
  }

  /// The nearest point of the line before a station, if it may be the same place.
  std::optional<Revisit> revisitOf(size_t station) const {
    std::optional<Revisit> best;
    for (size_t i = 0; i < station; ++i) {
      const Revisit revisit = project(station, i);
      if (revisit.length_m < options_.least_length_m) break;
      if (!best || revisit.offset_ENU.squaredNorm() < best->offset_ENU.squaredNorm()) best = revisit;
    }
    if (best && best->offset_ENU.cwiseQuotient(best->sigma_ENU).squaredNorm() > options_.most_squared)
      best.reset();
    return best;
  }

 private:
  const Vec3& position(size_t station) const { return survey_.stations[station].position_ENU; }
  Vec3 leg(size_t index) const { return position(index + 1) - position(index); }

  Revisit project(size_t station, size_t index) const {
    const Vec3 from_begin = position(station) - position(index);
    const double share =
        std::clamp(from_begin.dot(leg(index)) / std::max(leg(index).squaredNorm(), 1e-12), 0.0, 1.0);
    Revisit revisit;
    revisit.station = station;
    revisit.leg = index;
    revisit.offset_ENU = from_begin - share * leg(index);
    revisit.length_m = way_m_[station] - way_m_[index] - share * leg(index).norm();
    const double legs = static_cast<double>(station - index) - share;
    const double swim_variance = options_.swim_sigma_m * options_.swim_sigma_m;
    revisit.sigma_ENU =
        (legs * survey_.leg_sigma_ENU.cwiseAbs2() + Vec3::Constant(swim_variance)).cwiseSqrt();
    return revisit;
  }

  const Survey& survey_;
  const LoopOptions& options_;
  std::vector<double> way_m_;  ///< from the first station to each
};

LoopCandidate candidateOf(const std::vector<Revisit>& revisits) {
  const auto longest =
      std::max_element(revisits.begin(), revisits.end(),
                       [](const Revisit& a, const Revisit& b) { return a.length_m < b.length_m; });
  LoopCandidate candidate;
  candidate.first = revisits.front().station;
  candidate.last = revisits.back().station;
  candidate.station = longest->station;
  candidate.leg = longest->leg;
  candidate.misclosure_ENU = longest->offset_ENU;
  candidate.sigma_ENU = longest->sigma_ENU;
  candidate.length_m = longest->length_m;
  std::vector<double> sizes_m;
  for (const Revisit& revisit : revisits) sizes_m.push_back(revisit.offset_ENU.norm());
  candidate.median_misclosure_m = computeStatistics(sizes_m).median;
  return candidate;
}

}  // namespace

std::vector<LoopCandidate> findLoopCandidates(const Survey& survey, const LoopOptions& options) {
  const LineSearch line(survey, options);
  std::vector<LoopCandidate> candidates;
  std::vector<Revisit> consecutive;
  for (size_t station = 1; station <= survey.stations.size(); ++station) {
    const std::optional<Revisit> revisit =
        station < survey.stations.size() ? line.revisitOf(station) : std::nullopt;
    if (revisit) {
      consecutive.push_back(*revisit);
    } else if (!consecutive.empty()) {
      candidates.push_back(candidateOf(consecutive));
      consecutive.clear();
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const LoopCandidate& a, const LoopCandidate& b) { return a.length_m > b.length_m; });
  return candidates;
}

}  // namespace lodeline
