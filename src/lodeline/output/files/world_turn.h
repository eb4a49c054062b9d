#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "lodeline/estimator/magnetometer/magnetometer_fusion.h"

namespace lodeline {

/// Turn of a finished run's world about the vertical, to north that was found only after the first pose. The
/// files of a run grow in the world of the first pose; when the run ends they are turned as a whole, so that
/// y points to north from the first pose on.
struct WorldTurn {
  double angle_rad = 0.0;  ///< counter-clockwise seen from above
  double sigma_rad = 0.0;
  /// Rows before that know nothing of north: the turn's sigma comes on top of theirs.
  std::optional<Time> north_found;

  /// Nothing where the world of an estimate is the one in which files are to be.
  static std::optional<WorldTurn> of(const MagnetometerEstimate& last);

  Vec3 apply(const Vec3& vector_W) const;
};

/// Turns `trajectory<suffix>.tum` and `states<suffix>.csv` of StateWriter. Either is replaced at once, by
/// renaming. Throws InputError where a file cannot be read or written.
void turnStateFiles(const std::filesystem::path& folder, const std::string& suffix, const WorldTurn& turn);

}  // namespace lodeline
