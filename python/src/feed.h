#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "lodeline/odometry.h"
#include "python/src/estimate_table.h"

namespace lodeline::python {

/// Odometry on readings that are pushed by hand. A second thread estimates. Images that are pushed faster
/// than it works make push() wait, so that none is dropped. None of its functions needs Python's lock.
class Feed {
 public:
  Feed(const DescribedRig& rig, OdometrySettings settings, double patience_s);
  ~Feed();
  Feed(const Feed&) = delete;
  Feed& operator=(const Feed&) = delete;

  void push(const ImuSample& sample);
  /// Throws UsageError where the rig does not have the sensor, here and below.
  void push(const MagnetometerSample& sample) { pushTo(rig_.rig.magnetometer, "magnetometer", sample); }
  void push(const DepthSample& sample) { pushTo(rig_.rig.pressure, "pressure sensor", sample); }
  void push(const SonarSample& sample) { pushTo(rig_.rig.sonar, "sonar", sample); }
  void push(const AltimeterSample& sample) { pushTo(rig_.rig.altimeter, "altimeter", sample); }
  void push(const DvlSample& sample) { pushTo(rig_.rig.dvl, "DVL", sample); }
  void push(const CurrentSample& sample) { pushTo(rig_.rig.currents, "current sensor", sample); }
  /// Returns false after a short wait where the queue is full; the caller then tries again. Throws UsageError
  /// where the queue cannot empty, because inertial readings of the oldest images are missing.
  bool push(size_t camera, Time time, const cv::Mat& pixels);

  /// Names of the channels of the current sensor; empty without one.
  std::vector<std::string> currentChannels() const {
    return rig_.rig.currents.value_or(CurrentCalibration()).channels;
  }

  /// Ends the readings; the estimates of all of them follow.
  void close();
  /// Takes the estimates that are ready. Throws what ended the estimation.
  std::vector<FrameEstimate> take();
  /// Waits a short time for the end; returns whether it has come. Throws what ended the estimation.
  bool waitForEnd();
  /// All estimates so far, in the world of a finished run's files.
  EstimateTable estimates();
  /// Findings; throws UsageError before the end.
  Diagnostics findings();

 private:
  template <typename Sample>
  void pushOpen(const Sample& sample) {
    requireOpen();
    source_.push(sample);
  }
  template <typename Calibration, typename Sample>
  void pushTo(const std::optional<Calibration>& calibration, const char* name, const Sample& sample) {
    if (!calibration) throw UsageError(std::string("odometry: the rig has no ") + name);
    pushOpen(sample);
  }
  void requireOpen();
  void rethrow() const;
  /// Whether the oldest queued image of camera 0 has all readings that it needs.
  bool canGoOn() const;
  UsageError stuck(size_t queued) const;
  void estimate();

  DescribedRig rig_;
  OdometrySettings settings_;
  double patience_s_;
  Diagnostics diagnostics_;  ///< of the second thread until the end
  LiveSource source_;
  std::atomic<bool> is_abandoned_ = false;
  std::mutex mutex_;  ///< for all below
  std::condition_variable changed_;
  std::vector<FrameEstimate> ready_;
  EstimateTable table_;
  std::exception_ptr failure_;
  bool is_running_ = false;  ///< the rates of the sensors are known
  bool is_closed_ = false;
  bool has_ended_ = false;
  std::optional<Time> newest_imu_;
  std::deque<Time> waiting_images_;  ///< of camera 0, the newest ones that may still be queued
  std::thread thread_;               ///< last, so that all others exist before it starts
};

}  // namespace lodeline::python
