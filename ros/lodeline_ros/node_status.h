#pragma once

#include <chrono>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/estimator/estimator.h"
#include "lodeline/util/diagnostics.h"
#include "lodeline_ros/message_types.h"

namespace lodeline {

/// What the node says of itself in /diagnostics. The estimator's thread tells it, ROS's thread asks it.
class NodeStatus {
 public:
  /// A frame was estimated, within `work_s` of processing; `period_s` lies between frames, and `backlog`
  /// images wait.
  void add(const FrameEstimate& estimate, double work_s, double period_s, size_t backlog);
  void setFindings(std::vector<Finding> findings);

  /// Two statuses, of the estimator and of the magnetometer. `unheard`: sensors that have not been heard
  /// enough to begin. WARN while there is no full tracking or the magnetometer is rejected, ERROR where
  /// nothing was estimated for two seconds.
  message::DiagnosticArray message(ros::Time now, const std::vector<std::string>& unheard) const;

 private:
  using Clock = std::chrono::steady_clock;

  message::DiagnosticStatus estimatorStatus(const std::vector<std::string>& unheard) const;
  message::DiagnosticStatus magnetometerStatus() const;

  mutable std::mutex mutex_;
  std::optional<FrameEstimate> last_;
  Clock::time_point last_time_;
  int frames_ = 0;
  size_t backlog_ = 0;
  double busy_share_ = 0.0;  ///< of real time, mean over the latest frames
  std::vector<Finding> findings_;
};

}  // namespace lodeline
