#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "lodeline/geometry/rigid3.h"
#include "lodeline/util/diagnostics.h"
#include "lodeline/util/time/time.h"

namespace lodeline {

/// Pose of a body (or a camera) at one time, in the world of its trajectory.
struct StampedPose {
  Time time;
  Rigid3 world_from_body;
};

/// Origin of a trajectory's times. Formats without times (KITTI) number their rows: such a trajectory can
/// only be associated by index.
enum class TimeBase { Stamps, Index };

/// The world axis that points up. Camera-based formats (KITTI) have y down.
enum class WorldUp { Z, MinusY };

/// Poses in the order of their times; `sortByTime` sorts them.
struct Trajectory {
  std::string name;  ///< source, for messages
  TimeBase time_base = TimeBase::Stamps;
  WorldUp up = WorldUp::Z;
  std::size_t rows = 0;  ///< of a table without times, including skipped rows
  std::vector<StampedPose> poses;

  bool empty() const { return poses.empty(); }
  std::size_t size() const { return poses.size(); }
};

/// Orders the poses by time and keeps the first of several poses with the same time; both are reported as
/// warnings ("trajectory_disorder", "trajectory_duplicate").
void sortByTime(Trajectory& trajectory, Diagnostics& diagnostics);

/// The same trajectory in a world whose z axis points up.
Trajectory withZUp(Trajectory trajectory);

/// Path length (m) from the first pose to each pose; same size as `poses`, the first is 0.
std::vector<double> distancesFromStart(const std::vector<Rigid3>& world_from_body);

/// Path length (m) of the whole trajectory, 0 when it has fewer than two poses.
double pathLength(const Trajectory& trajectory);

/// Typical (median) interval between poses; zero when there are fewer than two.
Duration medianInterval(const Trajectory& trajectory);

}  // namespace lodeline
