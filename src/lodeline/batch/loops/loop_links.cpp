#include "lodeline/batch/loops/loop_links.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

void checkLoopObservation(const FeatureObservation& seen, size_t cameras) {
  if (seen.camera < 0 || static_cast<size_t>(seen.camera) >= cameras)
    throw InputError(
        fmt::format("A loop observation is of camera {}; the rig has {}.", seen.camera, cameras));
  const bool is_direction = seen.bearing_C.allFinite() && std::abs(seen.bearing_C.norm() - 1.0) < 1e-6;
  if (!is_direction || !seen.origin_C.allFinite() || !(seen.sigma_px > 0.0))
    throw InputError("A loop observation has no unit bearing or no positive sigma.");
}

}  // namespace

void LoopLinker::add(TrackId track, TrackId piece, size_t state) {
  std::vector<Piece>& of_track = pieces_[track];
  if (of_track.empty() || of_track.back().id != piece) of_track.push_back({piece, state, state});
  of_track.back().last = state;
}

std::optional<TrackId> LoopLinker::pieceAt(TrackId track, Time time) const {
  const auto found = pieces_.find(track);
  if (found == pieces_.end()) return std::nullopt;
  const auto distance_s = [&](const Piece& piece) {
    return std::max({(states_[piece.first] - time).seconds(), (time - states_[piece.last]).seconds(), 0.0});
  };
  return std::min_element(found->second.begin(), found->second.end(),
                          [&](const Piece& a, const Piece& b) { return distance_s(a) < distance_s(b); })
      ->id;
}

std::optional<size_t> LoopLinker::stateAt(Time time) const {
  const auto state = std::lower_bound(states_.begin(), states_.end(), time);
  if (state == states_.end() || *state != time) return std::nullopt;
  return static_cast<size_t>(state - states_.begin());
}

std::vector<LoopLink> LoopLinker::link(const std::vector<LoopObservation>& loops,
                                       const std::vector<std::shared_ptr<const Camera>>& cameras,
                                       Tracks* pieces) const {
  std::map<std::pair<TrackId, TrackId>, int> votes;
  // A corner may be matched with several old tracks; it is one observation.
  std::map<std::tuple<size_t, int, std::array<double, 3>>, TrackId> corners;
  TrackId next = pieces->empty() ? 0 : pieces->rbegin()->first + 1;
  for (const LoopObservation& loop : loops) {
    const FeatureObservation& seen = loop.observation;
    checkLoopObservation(seen, cameras.size());
    const std::optional<TrackId> old_piece = pieceAt(loop.old_track, loop.old_time);
    if (!old_piece) continue;
    std::optional<TrackId> new_piece;
    if (seen.track >= 0) {
      new_piece = pieceAt(seen.track, loop.new_time);
    } else if (const std::optional<size_t> state = stateAt(loop.new_time)) {
      const Vec3& bearing_C = seen.bearing_C;
      const std::array<double, 3> direction{bearing_C.x(), bearing_C.y(), bearing_C.z()};
      const auto [corner, is_new] = corners.try_emplace({*state, seen.camera, direction}, next);
      new_piece = corner->second;
      if (is_new) {
        Observation observation;
        observation.frame = static_cast<FrameId>(*state);
        observation.camera = seen.camera;
        observation.measurement = DirectionMeasurement::fromRay(*cameras[static_cast<size_t>(seen.camera)],
                                                                {seen.origin_C, bearing_C}, seen.sigma_px);
        (*pieces)[next++].observations.push_back(observation);
      }
    }
    if (new_piece && *new_piece != *old_piece) ++votes[std::minmax(*old_piece, *new_piece)];
  }
  std::vector<LoopLink> links;
  for (const auto& [pair, count] : votes) links.push_back({pair.first, pair.second, count});
  std::stable_sort(links.begin(), links.end(),
                   [](const LoopLink& a, const LoopLink& b) { return a.votes > b.votes; });
  return links;
}

}  // namespace lodeline
