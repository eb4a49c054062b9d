#pragma once

#include <deque>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/types.h"

namespace lodeline {

/// The stamps of a film's images from a table beside it: one stamp a line, the first column, with or without
/// a header. Memory holds all of them: 8 bytes an image.
class FrameStamps {
 public:
  /// Throws InputError where the file has no stamps. `diagnostics` must outlive the call.
  FrameStamps(const std::filesystem::path& file, Diagnostics* diagnostics);

  size_t count() const { return stamps_.size(); }
  std::optional<Time> next();
  /// The first stamps, as many as rates are measured from.
  std::vector<Time> first() const;

 private:
  std::vector<Time> stamps_;
  size_t next_ = 0;
};

}  // namespace lodeline
