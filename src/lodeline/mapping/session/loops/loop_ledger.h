#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "lodeline/mapping/keyframe/map_keyframe.h"

namespace lodeline {

/// Names and times of the keyframes of a loop, for people.
struct LoopPlaces {
  std::string old_dive, new_dive;
  Time old_time, new_time;
};

/// A text as one field of a CSV file: in quotes where it contains a comma or a quote.
std::string csvField(const std::string& text);

/// Writes `loops.csv`: one row for each candidate with all its numbers, and the reason for which it went no
/// further. Each row is flushed, so that an interrupted run keeps the ledger.
class LoopLedger {
 public:
  /// Throws InputError where the file cannot be written.
  explicit LoopLedger(const std::filesystem::path& file);

  void write(const Loop& loop, const LoopPlaces& places);

 private:
  void flush();

  std::filesystem::path file_;
  std::ofstream stream_;
};

}  // namespace lodeline
