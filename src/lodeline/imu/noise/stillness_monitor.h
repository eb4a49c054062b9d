#pragma once

#include <optional>
#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// Limits for a stationary sensor; [u] is the unit of its reading.
struct StillLimits {
  double largest_std = 0.0;   ///< [u], root mean square over the axes within ten seconds
  double largest_step = 0.0;  ///< [u], change of the mean between neighbouring ten-second windows
};

/// Result of the stationary test over the record's ten-second windows.
struct Stillness {
  int windows = 0;
  int moved = 0;                    ///< number of windows beyond the limits
  std::optional<Time> first_moved;  ///< start of the first of them
  double median_std = 0.0;          ///< [u]

  double movedShare() const { return windows == 0 ? 0.0 : static_cast<double>(moved) / windows; }
};

/// Stationary detector for readings of a sensor at rest. A window counts as moved where its scatter exceeds
/// the limit or three times the median window's. So does one whose mean changes from the previous window's.
class StillnessMonitor {
 public:
  explicit StillnessMonitor(const StillLimits& limits) : limits_(limits) {}

  void add(Time time, const Vec3& reading);
  Stillness result() const;

 private:
  struct Window {
    Time begin;
    float std = 0.0F;
    float step = 0.0F;
  };
  void close();

  StillLimits limits_;
  std::vector<Window> windows_;
  std::optional<Time> begin_;
  Vec3 origin_ = Vec3::Zero();  ///< first reading of the window, subtracted for numerical precision
  Vec3 sum_ = Vec3::Zero();
  Vec3 squares_ = Vec3::Zero();
  int count_ = 0;
  std::optional<Vec3> last_mean_;
};

}  // namespace lodeline
