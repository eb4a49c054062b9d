#pragma once

#include <chrono>
#include <map>
#include <optional>
#include <vector>

#include "lodeline/batch/estimator_log.h"
#include "lodeline/estimator/attitude_track.h"
#include "lodeline/estimator/odometry.h"
#include "lodeline/inspection/clock_monitor.h"
#include "lodeline/io/synchronizer/measurement_source.h"
#include "lodeline/io/synchronizer/synchronizer.h"
#include "lodeline/output/files/run_output.h"
#include "lodeline/output/report/run_summary.h"
#include "lodeline/pipeline/run_request.h"
#include "lodeline/pipeline/run_settings.h"
#include "lodeline/util/diagnostics.h"
#include "lodeline/util/files/folder_lock.h"
#include "lodeline/util/settings/settings.h"

namespace lodeline {

/// The estimator's way through a source, packet by packet, with the folder of results (see README) that grows
/// on the way:
///
///     while (session.fetch()) session.process();
///     session.finish();
class RunSession {
 public:
  /// Applies the magnetometer's calibration that `options` name to the source, makes the folder of results
  /// and writes the settings to it; writes nothing where the request names no folder. `settings` are bound to
  /// `options`; `source` and `diagnostics` must outlive the session. Throws InputError and UsageError.
  RunSession(const RunRequest& request, const Settings& settings, const RunSettings& options,
             RecordedSource* source, Diagnostics* diagnostics);

  /// Waits for the next packet; false at the source's end.
  bool fetch();
  /// Takes the fetched packet through front end, estimator and files. Throws InputError.
  void process();
  /// Completes the files, the refined ones too where the request asks for them. A packet that was fetched but
  /// not processed says that the user ended the run.
  RunSummary finish();

  /// Of the packet processed last.
  const FramePacket& packet() const { return processed_; }
  const FrameEstimate& estimate() const { return summary_.last(); }
  /// That left the window with it.
  const std::vector<MapPoint>& landmarks() const { return landmarks_; }
  const RunSummary& summary() const { return summary_; }
  const Odometry& odometry() const { return odometry_; }

 private:
  void followClocks(const FrameEstimate& estimate);
  bool stamp(FrameEstimate* estimate);

  using Clock = std::chrono::steady_clock;

  std::string folder_;  ///< empty for none
  std::optional<FolderLock> lock_;
  Diagnostics* diagnostics_;
  Synchronizer synchronizer_;
  Odometry odometry_;
  Diagnostics unheard_;  ///< what the filter finds wrong with readings, synchronizer and odometry report too
  AttitudeTrack attitude_;
  RunSummary summary_;
  std::optional<RunOutput> output_;
  std::optional<EstimatorLog> record_;  ///< of a run that is to be refined
  std::optional<FramePacket> fetched_;
  FramePacket processed_;
  ClockMonitor clocks_;
  Duration image_offset_;  ///< from the clock of the images to that of the results
  std::optional<Time> last_result_stamp_;
  std::map<Time, Time> result_stamps_;  ///< of frames whose results have another stamp than their time
  std::vector<MapPoint> landmarks_;
  Clock::time_point start_;
  double start_processor_s_ = 0.0;
};

}  // namespace lodeline
