#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "lodeline/estimate.h"

namespace lodeline {

/// Rotation of a finished run's world about the vertical, to a north that was found after the first pose.
/// During the run the files are in the world of the first pose. At its end they are rotated as a whole, so
/// that y points north from the first pose on.
struct WorldTurn {
  double angle_rad = 0.0;  ///< counter-clockwise seen from above
  double sigma_rad = 0.0;
  /// Rows before this time are independent of north: the rotation's sigma is added to theirs.
  std::optional<Time> north_found;

  /// Empty where the world of an estimate is already that of the files.
  static std::optional<WorldTurn> of(const MagnetometerEstimate& last);

  Vec3 apply(const Vec3& vector_W) const;
  Rigid3 apply(const Rigid3& world_from_body) const;
  /// Variance of the rotation, rad^2, that the covariance of an estimate at this time does not contain.
  double missingVariance_rad2(Time time) const;
  /// Covariance of a pose, [dp, dtheta] in world axes (m, rad). `position_W`: after the rotation.
  Mat6 applyToCovariance(const Mat6& covariance, Time time, const Vec3& position_W) const;
};

/// Rotates the first `most` poses of a file in TUM format, or all. Replaces the file atomically by renaming.
/// Throws InputError where it cannot be read or written.
void turnTrajectoryFile(const std::filesystem::path& file, const WorldTurn& turn,
                        std::optional<size_t> most = std::nullopt);

/// Rotates `trajectory<suffix>.tum` and `states<suffix>.csv` of StateWriter. Each file is replaced atomically
/// by renaming. Throws InputError where a file cannot be read or written.
void turnStateFiles(const std::filesystem::path& folder, const std::string& suffix, const WorldTurn& turn);

}  // namespace lodeline
