#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "lodeline/estimator/state/window.h"
#include "lodeline/output/files/world_turn.h"

namespace lodeline {

/// Writes `landmarks.ply` (binary, positions in the world in metres and the number of observations),
/// streaming: finish() fills in the header. Without it the header says that the run was not completed, and
/// the destructor fills in the count alone.
class LandmarkWriter {
 public:
  /// Throws InputError where the folder cannot be written to.
  explicit LandmarkWriter(const std::filesystem::path& folder, const std::string& name = "landmarks.ply");
  ~LandmarkWriter();
  LandmarkWriter(const LandmarkWriter&) = delete;
  LandmarkWriter& operator=(const LandmarkWriter&) = delete;

  void write(const std::vector<MapPoint>& points);
  /// Turns all points, where they have to be, and says in the header what x and y of their world are. Throws
  /// InputError where not all could be written.
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
