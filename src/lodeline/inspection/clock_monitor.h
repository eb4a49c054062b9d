#pragma once

#include <deque>
#include <map>
#include <optional>
#include <span>

#include "lodeline/diagnostics.h"
#include "lodeline/frontend/tracking/tracks.h"
#include "lodeline/inspection/survey/turn_comparison.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Checks during a run whether the clocks of images and IMU agree. It compares the rotation of camera 0
/// between images, from the tracked points alone, with the gyroscope's over the last few seconds. inspect()
/// does the same for parts of a recording. A time offset far beyond the usual calibration errors, in two
/// successive comparisons, is reported as `camera_time_offset`, and each later change of it as
/// `camera_clock_jump`. There are no comparisons while the rig hardly rotates. The monitor needs less than a
/// hundredth of a frame's time.
class ClockMonitor {
 public:
  explicit ClockMonitor(const Rig& rig);

  /// `imu`: the readings up to the frame, as in FramePacket. Frames must come in order of time. Returns the
  /// time to add to the images' stamps, s, when an offset or a change of it has just been reported.
  std::optional<double> add(const FrameTracks& tracks, std::span<const ImuSample> imu,
                            Diagnostics* diagnostics);

  /// To be called when the time stamps of later images are shifted by `by_s`.
  void move(double by_s);

 private:
  void addTurn(const FrameTracks& tracks);
  void forget(Time now);
  bool keepTogether(const GyroscopeIntegral& gyroscope) const;
  std::optional<double> compare(Time now, Diagnostics* diagnostics);
  void report(Time now, double offset_s, double sigma_s, Diagnostics* diagnostics);

  std::string camera_;
  Quat body_from_camera_;
  std::map<TrackId, Vec3> rays_;  ///< of the first image of the next rotation
  std::optional<Time> rays_time_;
  std::deque<CameraTurn> turns_;
  std::deque<ImuSample> imu_;
  std::optional<Time> next_comparison_;
  std::optional<double> suspected_s_;  ///< offset from the previous comparison
  std::optional<double> offset_s_;     ///< last reported offset
};

}  // namespace lodeline
