#pragma once

#include <array>
#include <map>
#include <optional>

#include "lodeline/magnetometer/field_map/field_map_tile.h"
#include "lodeline/types.h"

namespace lodeline {

/// Form of a map of a magnetic anomaly.
struct FieldMapOptions {
  double length_scale_m = 1.5;  ///< over which the anomaly changes
  double field_sigma_T = 6e-6;  ///< of each component of the anomaly, where nothing is known
  /// A tile that knows a place better than this, per axis, learns nothing more there. So its last reading is
  /// that of the first visit.
  double known_sigma_T = 0.7e-6;
  int max_tiles = 256;  ///< the one that was not visited for the longest time makes room for a new one
};

/// How well the state was known from which a reading of the map was taken: variances relative to one
/// reference.
struct FieldMapOrigin {
  Time time;
  double heading_variance_rad2 = 0.0;
  double position_variance_m2 = 0.0;  ///< of each coordinate
};

/// The anomaly at a place, and means over the readings from which it is known.
struct FieldMapPrediction {
  PredictedField anomaly;
  double heading_variance_rad2 = 0.0;
  double position_variance_m2 = 0.0;
  Time last_reading;
};

/// A map of a magnetic anomaly along a path, in tiles: cubes in a grid, each inside a larger box with basis
/// functions (FieldMapTile). A tile answers for places in its cube. It learns from readings in its cube and
/// in a margin around it. The field vanishes at the faces of the box, beyond the margin. Sizes in length
/// scales, from the centre: cube 1.25, margin 2, box 3.
class FieldMap {
 public:
  explicit FieldMap(const FieldMapOptions& options);

  bool empty() const { return tiles_.empty(); }
  int tiles() const { return static_cast<int>(tiles_.size()); }
  const PotentialBasis& basis() const { return basis_; }

  /// Learns an anomaly (T) at a place (m), with the covariance of its independent error.
  void learn(const Vec3& place, const Vec3& anomaly, const Mat3& covariance, const FieldMapOrigin& origin);

  /// Empty where there is no tile.
  std::optional<FieldMapPrediction> predict(const Vec3& place);

  /// Removes the tiles that have learnt, or would learn, from a reading at a place.
  void forget(const Vec3& place);

 private:
  using Cell = std::array<int, 3>;
  struct Entry {
    FieldMapTile tile;
    int readings = 0;
    double heading_variance_sum = 0.0, position_variance_sum = 0.0;
    Time last_reading;
    int64_t last_visit = 0;
  };
  Cell cellOf(const Vec3& place) const;
  Vec3 centreOf(const Cell& cell) const;
  /// Calls `act` for each cell whose margin contains a place.
  template <typename Act>
  void forCellsAround(const Vec3& place, const Act& act) const;
  void makeRoom();

  FieldMapOptions options_;
  PotentialBasis basis_;
  std::map<Cell, Entry> tiles_;
  int64_t visits_ = 0;
};

}  // namespace lodeline
