#pragma once

#include <optional>
#include <vector>

#include "lodeline/recording.h"
#include "lodeline/trajectory.h"

namespace lodeline {

/// Images of one time whose depths are computed.
struct KeyframeView {
  size_t number = 0;  ///< counts from 0 along the dive
  Time time;          ///< on the clock of the trajectory
  Rigid3 map_from_body;
  std::vector<PendingImage> images;  ///< of the first one or two cameras
};

/// Distance from one keyframe to the next: whichever is reached first.
struct KeyframeSteps {
  double step_m = 0.15;
  double step_rad = 0.26;  ///< 15 degrees
};

/// Goes through a recording and chooses keyframes at even steps of its trajectory. Images without a pose, and
/// images of the first camera without one of the second at the same time (within 3 ms), are passed over.
class KeyframeViews {
 public:
  /// `cameras`: with their delays; the first one or two are used. Keeps references to all but the steps.
  KeyframeViews(MeasurementSource& source, const std::vector<CameraCalibration>& cameras,
                const Trajectory& trajectory, const KeyframeSteps& steps)
      : source_(source), cameras_(cameras), trajectory_(trajectory), steps_(steps) {}

  std::optional<KeyframeView> next();

 private:
  Time timeOf(size_t camera, const PendingImage& image) const {
    return image.time + Duration::fromSeconds(cameras_[camera].time_offset_to_imu_s);
  }
  std::optional<PendingImage> partnerAt(Time time);
  bool isFar(const Rigid3& map_from_body) const;

  MeasurementSource& source_;
  const std::vector<CameraCalibration>& cameras_;
  const Trajectory& trajectory_;
  KeyframeSteps steps_;
  std::optional<PendingImage> partner_;  ///< read but not used yet
  std::optional<Rigid3> last_;
  size_t number_ = 0;
};

}  // namespace lodeline
