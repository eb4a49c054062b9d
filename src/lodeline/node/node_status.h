#pragma once

#include <chrono>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/estimate.h"
#include "lodeline_ros/message_types.h"

namespace lodeline {

/// Status of the node for /diagnostics. The estimator's thread writes it, ROS's thread reads it.
class NodeStatus {
 public:
  /// Adds an estimated frame. `work_s`: its processing time; `period_s`: time between frames; `backlog`:
  /// number of waiting images.
  void add(const FrameEstimate& estimate, double work_s, double period_s, size_t backlog);
  void setFindings(std::vector<Finding> findings);

  /// Statuses of the estimator and of the magnetometer. `unheard`: sensors without enough readings to start.
  /// WARN while tracking is incomplete or the magnetometer is rejected; ERROR where there was no estimate for
  /// two seconds.
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
  double busy_share_ = 0.0;  ///< processing time divided by real time, mean over the latest frames
  std::vector<Finding> findings_;
};

}  // namespace lodeline
