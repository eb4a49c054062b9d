#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "lodeline/estimator/window.h"

namespace lodeline {

/// Writes `landmarks.ply` (binary, positions in the world in metres and the number of sightings), streaming:
/// the count in the header is filled in by finish(), which the destructor calls too, but without throwing.
class LandmarkWriter {
 public:
  /// Throws InputError where the folder cannot be written to.
  explicit LandmarkWriter(const std::filesystem::path& folder, const std::string& name = "landmarks.ply");
  ~LandmarkWriter();
  LandmarkWriter(const LandmarkWriter&) = delete;
  LandmarkWriter& operator=(const LandmarkWriter&) = delete;

  void write(const std::vector<MapPoint>& points);
  /// Throws InputError where not all could be written.
  void finish();
  int64_t count() const { return count_; }

 private:
  std::filesystem::path file_;
  std::ofstream stream_;
  int64_t count_ = 0;
};

}  // namespace lodeline
