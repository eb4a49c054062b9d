#pragma once

#include <chrono>
#include <optional>
#include <vector>

#include "lodeline/api/estimation_loop.h"
#include "lodeline/api/run_settings.h"
#include "lodeline/diagnostics.h"
#include "lodeline/estimator/attitude_track.h"
#include "lodeline/mapping/session/run_mapping.h"
#include "lodeline/output/files/run_output.h"
#include "lodeline/output/report/run_summary.h"
#include "lodeline/pipeline/run_request.h"
#include "lodeline/recording.h"
#include "lodeline/util/files/folder_lock.h"
#include "lodeline/util/settings/settings.h"

namespace lodeline {

/// Runs the estimator over a source, packet by packet, and writes the output folder (see README) during the
/// run:
///
///     while (session.fetch()) session.process();
///     session.finish();
class RunSession {
 public:
  /// Applies the magnetometer calibration named in `options` to the source, creates the output folder and
  /// writes the settings to it; writes nothing where the request names no folder. `settings` are bound to
  /// `options`; `source` and `diagnostics` must outlive the session. Throws InputError and UsageError.
  RunSession(const RunRequest& request, const Settings& settings, const RunSettings& options,
             RecordedSource* source, Diagnostics* diagnostics);

  /// Reads the next packet; returns false at the end of the source.
  bool fetch() { return loop_.fetch(); }
  /// Time of the packet that fetch() read.
  Time fetchedTime() const { return loop_.fetchedTime(); }
  /// Processes the fetched packet with front end, estimator and writers. Throws InputError.
  void process();
  /// Completes the files, including the refined ones if the request asks for them. A packet that was fetched
  /// but not processed means that the user ended the run.
  RunSummary finish();

  /// Packet processed last.
  const FramePacket& packet() const { return loop_.packet(); }
  const FrameEstimate& estimate() const { return summary_.last(); }
  /// Whether its stamp is later than all before; only then the files have it.
  bool hasNewStamp() const { return loop_.hasNewStamp(); }
  /// Landmarks that left the window with it.
  const std::vector<MapPoint>& landmarks() const { return landmarks_; }
  const RunSummary& summary() const { return summary_; }
  const PacketOdometry& odometry() const { return loop_.odometry(); }
  /// From the odometry's world to the map's, see RunMapping; empty where the run has no map.
  std::optional<Rigid3> mapFromOdom() const {
    return mapping_ ? mapping_->mapFromOdom(summary_.last()) : std::nullopt;
  }

 private:
  using Clock = std::chrono::steady_clock;

  std::string folder_;  ///< empty for none
  bool quiet_;          ///< shows no progress
  std::optional<FolderLock> lock_;
  Diagnostics* diagnostics_;
  EstimationLoop loop_;
  Diagnostics unheard_;  ///< findings of the attitude filter, which synchronizer and odometry report as well
  AttitudeTrack attitude_;
  RunSummary summary_;
  std::optional<RunOutput> output_;
  std::optional<RunMapping> mapping_;
  std::vector<MapPoint> landmarks_;
  Clock::time_point start_;
  double start_processor_s_ = 0.0;
};

}  // namespace lodeline
