#pragma once

#include "lodeline/mapping/store/map_file.h"

namespace lodeline {

/// One transaction on a map file: all of it is written by commit(), or nothing. Keyframes go to the disk bit
/// by bit, so a change may be as long as a dive. The MapFile must outlive it.
///
/// Values that no map can hold (not finite, a covariance that is none, an unknown keyframe) are an
/// InputError.
class MapChange {
 public:
  MapChange(MapChange&& other) noexcept;
  MapChange& operator=(MapChange&&) = delete;
  ~MapChange();  ///< undoes everything unless commit() was called

  /// After this the object cannot be used any more.
  void commit();

  void setDescription(const MapDescription& description);

  /// Returns the number of the new dive; `dive.id` is ignored. Throws InputError where the name is taken.
  DiveId addDive(const MapDive& dive);
  /// Replaces all but the number.
  void updateDive(const MapDive& dive);
  /// Removes the dive with its keyframes, edges, loops and observations of control points, and control points
  /// of unknown position without any observation left.
  void removeDive(DiveId dive);

  /// Adds a keyframe to keyframe.dive. A negative id is replaced by the next free one; otherwise it must be
  /// greater than all ids so far. Returns the id.
  KeyframeId addKeyframe(const MapKeyframe& keyframe);
  /// Removes one keyframe with what belongs to it, for a sparser map.
  void removeKeyframe(KeyframeId id);
  void setSolution(KeyframeId id, const SolvedPose& pose);
  void clearSolution();  ///< of all keyframes

  void addEdge(const OdometryEdge& edge);

  int64_t addLoop(const Loop& loop);  ///< returns its number
  void updateLoop(const StoredLoop& loop);
  void clearLoops();

  /// Adds the point, or replaces the one with that name and keeps its observations. Returns its number.
  int64_t putControlPoint(const ControlPoint& point);
  void removeControlPoint(int64_t id);
  void addControlObservation(const ControlObservation& observation);

 private:
  friend class MapFile;
  explicit MapChange(Database* database);
  void addField(KeyframeId id, const KeyframeField& field);

  Database* database_;  ///< null after commit or move
};

}  // namespace lodeline
