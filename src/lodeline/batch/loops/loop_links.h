#pragma once

#include <map>
#include <memory>
#include <optional>
#include <unordered_map>
#include <vector>

#include "lodeline/batch/loops/loop_observation.h"
#include "lodeline/cameras/camera.h"
#include "lodeline/problem/state/window.h"

namespace lodeline {

/// Two tracks of the batch problem that show the same point, if the loop observations are right.
struct LoopLink {
  TrackId older = 0, newer = 0;  ///< by their numbers
  int votes = 0;                 ///< number of loop observations
};

/// Finds the tracks of the batch problem that loop observations connect. A long track of the record has
/// several pieces; each is a track of the problem.
class LoopLinker {
 public:
  /// `states`: the times of all states, ascending.
  explicit LoopLinker(std::vector<Time> states) : states_(std::move(states)) {}

  /// Tells that an observation of a track of the record at a state belongs to a piece, in order of time.
  void add(TrackId track, TrackId piece, size_t state);

  /// The links, most votes first. Each observation without a track becomes a new piece in
  /// `pieces`, unless its time is not that of a state. Loop observations of unknown tracks are left out.
  /// Throws InputError where an observation has no such camera or no direction.
  std::vector<LoopLink> link(const std::vector<LoopObservation>& loops,
                             const std::vector<std::shared_ptr<const Camera>>& cameras, Tracks* pieces) const;

 private:
  struct Piece {
    TrackId id;
    size_t first, last;  ///< states
  };
  /// The piece of a track that contains a time, or the nearest one.
  std::optional<TrackId> pieceAt(TrackId track, Time time) const;
  std::optional<size_t> stateAt(Time time) const;

  std::vector<Time> states_;
  std::unordered_map<TrackId, std::vector<Piece>> pieces_;
};

}  // namespace lodeline
