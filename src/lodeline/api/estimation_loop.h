#pragma once

#include <map>
#include <optional>

#include "lodeline/api/run_settings.h"
#include "lodeline/batch/estimator_log.h"
#include "lodeline/diagnostics.h"
#include "lodeline/estimator/packet_odometry.h"
#include "lodeline/inspection/clock_monitor.h"
#include "lodeline/io/synchronizer/synchronizer.h"
#include "lodeline/recording.h"

namespace lodeline {

/// Estimates the state at every image of a source, packet by packet:
///
///     while (loop.fetch()) loop.process();
///     loop.finish();
class EstimationLoop {
 public:
  /// Applies the magnetometer calibration named in `options` and plausible noise densities to the source.
  /// `source` and `diagnostics` must outlive the loop. Throws InputError and UsageError.
  EstimationLoop(const RunSettings& options, RecordedSource* source, Diagnostics* diagnostics);

  /// Keeps what the batch solution needs, from the next packet on (EstimatorLog).
  void record(double state_interval_s) { record_.emplace(state_interval_s); }
  /// Makes the frame processed last a state of the batch solution.
  void keepNewest() { record_->keepNewest(); }

  /// Reads the next packet; returns false at the end of the source.
  bool fetch();
  /// Processes the fetched packet with front end and estimator. Throws InputError.
  void process();
  /// To be called after the last packet.
  void finish();

  /// Whether a packet was fetched but not processed.
  bool isPending() const { return fetched_.has_value(); }
  /// Time of the packet that fetch() read and process() has not processed yet.
  Time fetchedTime() const { return fetched_->time; }
  /// Packet processed last, and its estimate.
  const FramePacket& packet() const { return processed_; }
  const FrameEstimate& estimate() const { return estimate_; }
  /// Whether the estimate's stamp is later than all before.
  bool hasNewStamp() const { return has_new_stamp_; }

  PacketOdometry& odometry() { return odometry_; }
  const PacketOdometry& odometry() const { return odometry_; }
  const Synchronizer& synchronizer() const { return synchronizer_; }
  const std::optional<EstimatorLog>& log() const { return record_; }
  /// Stamps of frames whose results have another stamp than their time.
  const std::map<Time, Time>& resultStamps() const { return result_stamps_; }

 private:
  void followClocks();
  void stamp();

  Diagnostics* diagnostics_;
  Synchronizer synchronizer_;
  PacketOdometry odometry_;
  std::optional<EstimatorLog> record_;
  std::optional<FramePacket> fetched_;
  FramePacket processed_;
  FrameEstimate estimate_;
  bool has_new_stamp_ = false;
  ClockMonitor clocks_;
  Duration image_offset_;  ///< from the clock of the images to that of the results
  std::optional<Time> last_result_stamp_;
  std::map<Time, Time> result_stamps_;
};

}  // namespace lodeline
