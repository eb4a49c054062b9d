// Information that loops add to the system of a BatchProblem.
#include "lodeline/batch/batch_problem.h"
#include "lodeline/problem/marginalization/landmark_host.h"

namespace lodeline {
namespace {

/// The observations of a joined landmark that belong to one of its parts, with the same position.
FeatureTrack partOf(const FeatureTrack& joined, const FeatureTrack& part, const Window& window,
                    const FactorBuilder& factors) {
  FeatureTrack alone = joined;
  std::erase_if(alone.observations, [&](const Observation& observation) {
    return part.find(observation.frame, observation.camera) == nullptr;
  });
  const FrameId host = alone.landmark->host;
  if (alone.find(host, 0) == nullptr) moveToNewHost(window, alone, host, factors);
  return alone;
}

}  // namespace

Eigen::MatrixXd BatchProblem::loopInformationTimes(const std::vector<Eigen::MatrixXd>& pose_changes) {
  const BlockSkylineCholesky rows = emptyMatrix();
  const Eigen::Index columns = pose_changes.front().cols();
  Eigen::MatrixXd product = Eigen::MatrixXd::Zero(rows.size(), columns);
  std::unordered_map<const double*, size_t> state_of;
  for (size_t k = 0; k < states(); ++k) state_of[state(k).pose.data()] = k;
  const auto add = [&](FeatureTrack& track, double sign) {
    if (!track.landmark) return;
    NormalEquations terms;
    terms.addEliminated(factors_.landmark(window_, track));
    Eigen::MatrixXd changes = Eigen::MatrixXd::Zero(terms.size(), columns);
    for (const NormalEquations::Block& block : terms.blocks()) {
      const auto known = state_of.find(block.value);
      if (known != state_of.end()) changes.middleRows(block.offset, 6) = pose_changes[known->second];
    }
    const Eigen::MatrixXd forces = sign * terms.hessian() * changes;
    for (const NormalEquations::Block& block : terms.blocks()) {
      product.middleRows(rows.offset(rowOf(block.value)), block.tangentSize()) +=
          forces.middleRows(block.offset, block.tangentSize());
    }
  };
  for (const JoinedLandmark& joined : joined_.landmarks) {
    const auto entry = window_.tracks().find(joined.parts.front());
    if (entry == window_.tracks().end() || !entry->second.landmark) continue;
    add(entry->second, 1.0);
    for (const TrackId part : joined.parts) {
      FeatureTrack alone = partOf(entry->second, all_tracks_.at(part), window_, factors_);
      add(alone, -1.0);
    }
  }
  return product;
}

}  // namespace lodeline
