#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/mapping/store/map_records.h"

namespace lodeline {

class Database;
class MapChange;

/// A map on disk: one SQLite file. Dives with their keyframes and features, odometry edges, the ledger of
/// loops, control points and the common solution. docs/reference/map-file.md describes the schema.
///
///     MapFile map = MapFile::openOrCreate("cave.db", {});
///     MapChange change = map.change();
///     dive.id = change.addDive(dive);
///     for (...) change.addKeyframe(keyframe);  // to the disk bit by bit
///     change.commit();                         // without it, the map stays as it was
///
/// Everything is read on demand, so memory use does not depend on the size of the map. A program that is
/// killed leaves the map of its last commit. Other programs can read during a change, and see the map before
/// it. One object serves one thread.
///
/// All functions throw InputError naming the file where it is damaged, locked or cannot be read or written.
class MapFile {
 public:
  enum class Access { Read, Change };

  /// Throws InputError where the file exists.
  static MapFile create(const std::filesystem::path& file, const MapDescription& description);
  /// Throws InputError where the file is missing, no map, or a map of a newer version.
  static MapFile open(const std::filesystem::path& file, Access access);
  /// Creates the map where it is missing. `description` is that of a new map.
  static MapFile openOrCreate(const std::filesystem::path& file, const MapDescription& description);

  MapFile(MapFile&&) noexcept;
  MapFile& operator=(MapFile&&) noexcept;
  ~MapFile();

  const std::filesystem::path& path() const { return path_; }
  MapDescription description() const;

  std::vector<MapDive> dives() const;  ///< in the order in which they were added
  /// Nothing where there is no such dive.
  std::optional<MapDive> findDive(const std::string& name) const;

  /// Calls `use` for each keyframe of a dive without its features, in the order of addition. `use` may change
  /// the map.
  void forEachKeyframe(DiveId dive, const std::function<void(const StoredKeyframe&)>& use) const;
  /// A keyframe without its features; nothing where there is no such keyframe.
  std::optional<StoredKeyframe> keyframe(KeyframeId id) const;
  /// The features of a keyframe, with the precision of pack/feature_block.h. Empty where it has none.
  std::vector<MapFeature> features(KeyframeId id) const;
  /// A keyframe with its features. Throws InputError where there is none.
  MapKeyframe fullKeyframe(KeyframeId id) const;

  /// Calls `use` for each odometry edge of a dive, by its new keyframe.
  void forEachEdge(DiveId dive, const std::function<void(const OdometryEdge&)>& use) const;
  /// Calls `use` for each loop of the ledger, in the order of addition.
  void forEachLoop(const std::function<void(const StoredLoop&)>& use) const;

  std::vector<ControlPoint> controlPoints() const;
  std::vector<ControlObservation> controlObservations() const;

  MapSizes sizes() const;
  /// All faults of the file, none in a good one: SQLite's own check, foreign keys, unreadable features,
  /// numbers that are not finite, rotations that are not unit, covariances that are none. Reads everything.
  std::vector<MapFault> check() const;

  /// Begins a change. Waits up to 5 s for another program's change. Throws std::logic_error where a change of
  /// this object is open already.
  MapChange change();
  /// Gives the space of removed dives back to the disk. Not during a change.
  void compact();

 private:
  MapFile(std::filesystem::path path, std::unique_ptr<Database> database);

  std::filesystem::path path_;
  std::unique_ptr<Database> database_;
};

}  // namespace lodeline
