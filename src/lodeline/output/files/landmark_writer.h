#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "lodeline/estimate.h"
#include "lodeline/output/files/world_turn.h"

namespace lodeline {

/// Writes `landmarks.ply` (binary, positions in the world in metres and the number of observations) during
/// the run; finish() completes the header. Without it the header states that the run was not completed, and
/// the destructor writes only the number.
class LandmarkWriter {
 public:
  /// Throws InputError where the folder cannot be written to.
  explicit LandmarkWriter(const std::filesystem::path& folder, const std::string& name = "landmarks.ply");
  ~LandmarkWriter();
  LandmarkWriter(const LandmarkWriter&) = delete;
  LandmarkWriter& operator=(const LandmarkWriter&) = delete;

  void write(const std::vector<MapPoint>& points);
  /// Rotates all points if necessary, and writes the meaning of the world's x and y to the header. Throws
  /// InputError where writing has failed.
  void finish(HeadingReference reference, const std::optional<WorldTurn>& turn);
  int64_t count() const { return count_; }

 private:
  void writeCount();
  void turnPoints(const WorldTurn& turn) const;

  std::filesystem::path file_;
  std::ofstream stream_;
  int64_t count_ = 0;
};

}  // namespace lodeline
