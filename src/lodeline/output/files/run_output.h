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
  std::optional<double> draw_tracks_s;  ///< interval of TrackPictures in seconds
  bool sample_pictures = false;         ///< SamplePictures, for report.html
};

/// All files in a run's output folder that are written during the run.
class RunOutput {
 public:
  /// The folder must exist. Throws InputError where it cannot be written to, UsageError for a bad option.
  RunOutput(const std::filesystem::path& folder, const Estimator& estimator, const RunOutputOptions& options);

  /// To be called after each packet with its results; `estimate` is null where it has no stamp.
  /// Returns the landmarks that left the window and were written. Throws InputError where writing fails.
  std::vector<MapPoint> write(const FramePacket& packet, const FrameEstimate* estimate,
                              const std::optional<AttitudeEstimate>& attitude, PacketOdometry* odometry);

  /// Adds the landmarks that are still in the window and completes the files. Rotates them to north where it
  /// was found after the first pose (WorldTurn); `last`: as after the last frame. Returns the number of
  /// landmarks. Closes the files of the states.
  int64_t finish(const PacketOdometry& odometry, const MagnetometerEstimate& last);

  /// Processor time of the pictures so far.
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
