#pragma once

#include <chrono>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/estimate.h"
#include "lodeline/node/intake/sensor_traffic.h"
#include "lodeline/node/messages/diagnostic_message.h"

namespace lodeline {

/// Status of the node for /diagnostics. The estimator's thread writes it, the transport's thread reads it.
class NodeStatus {
 public:
  /// Adds an estimated frame. `work_s`: its processing time; `period_s`: time between frames; `backlog`:
  /// number of waiting images.
  void add(const FrameEstimate& estimate, double work_s, double period_s, size_t backlog);
  void setFindings(std::vector<Finding> findings);

  /// Statuses of the estimator, the magnetometer and the sensors' topics. `unheard`: sensors without enough
  /// readings to start. WARN while tracking is incomplete, the magnetometer is rejected, or messages of a
  /// sensor were lost or of no use since the call before; ERROR where there was no estimate for two seconds.
  std::vector<DiagnosticStatus> statuses(const std::vector<std::string>& unheard,
                                         const std::vector<SensorTraffic>& traffic);

 private:
  using Clock = std::chrono::steady_clock;

  DiagnosticStatus estimatorStatus(const std::vector<std::string>& unheard) const;
  DiagnosticStatus magnetometerStatus() const;
  DiagnosticStatus sensorsStatus(const std::vector<SensorTraffic>& traffic);

  std::mutex mutex_;
  std::optional<FrameEstimate> last_;
  Clock::time_point last_time_;
  int frames_ = 0;
  size_t backlog_ = 0;
  double busy_share_ = 0.0;  ///< processing time divided by real time, mean over the latest frames
  std::vector<Finding> findings_;
  uint64_t told_losses_ = 0;  ///< messages that were lost or of no use, at the call before
};

}  // namespace lodeline
