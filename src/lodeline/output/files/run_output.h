#pragma once

#include <filesystem>
#include <optional>

#include "lodeline/estimator/attitude_track.h"
#include "lodeline/output/files/landmark_writer.h"
#include "lodeline/output/files/magnetometer_writer.h"
#include "lodeline/output/files/sample_pictures.h"
#include "lodeline/output/files/state_writer.h"
#include "lodeline/output/files/timing_writer.h"
#include "lodeline/output/files/track_pictures.h"

namespace lodeline {

struct RunOutputOptions {
  std::optional<double> draw_tracks_s;  ///< TrackPictures, one each so many seconds
  bool sample_pictures = false;         ///< SamplePictures, for report.html
};

/// All files of a run's output folder that grow while it goes on.
class RunOutput {
 public:
  /// The folder must exist. Throws InputError where it cannot be written to, UsageError for a bad option.
  RunOutput(const std::filesystem::path& folder, const Rig& rig, const RunOutputOptions& options);

  /// To be called after each packet with what became of it; `estimate` is null where it has no stamp of its
  /// own. Gives the landmarks that left the window and were written. Throws InputError where writing fails.
  std::vector<MapPoint> write(const FramePacket& packet, const FrameEstimate* estimate,
                              const std::optional<AttitudeEstimate>& attitude, Odometry* odometry);

  /// Adds the landmarks that are still in the window, completes the files and turns them to north where that
  /// was found only after the first pose (WorldTurn); `last`: as after the last frame. Gives the number of
  /// landmarks. The states' files are closed by it.
  int64_t finish(const Odometry& odometry, const MagnetometerEstimate& last);

  /// Processor time that pictures have taken so far.
  double picturesSeconds() const { return pictures_s_; }

 private:
  std::filesystem::path folder_;
  std::optional<StateWriter> states_;
  LandmarkWriter landmarks_;
  TimingWriter timings_;
  std::optional<MagnetometerWriter> magnetometer_;
  std::optional<TrackPictures> track_pictures_;
  std::optional<SamplePictures> sample_pictures_;
  double pictures_s_ = 0.0;
};

}  // namespace lodeline
