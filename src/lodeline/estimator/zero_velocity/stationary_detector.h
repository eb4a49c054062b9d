#pragma once

#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "lodeline/ahrs/rest_detector.h"
#include "lodeline/frontend/tracking/tracks.h"
#include "lodeline/problem/options/options.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Gyroscope bias from rests: at zero rotation the gyroscope reads its bias.
struct GyroscopeAtRest {
  Vec3 bias_B;  ///< rad/s
  double sigma_rad_per_s;
};

/// Detects that a rig is at rest: its inertial readings stay close to their means, and its images do not
/// change. This is more information than the observations themselves. Points that do not move in the image
/// could also be infinitely far from a rig that glides. One camera with a wrong velocity from dead reckoning
/// interprets them so. No cave is that large.
class StationaryDetector {
 public:
  StationaryDetector(const Rig& rig, const RestOptions& options);

  /// Adds frames in order, with the readings since the frame before. Returns true for a zero-velocity update
  /// at the frame: at most once in `RestOptions::span_s`, because the residual motion is correlated over
  /// time.
  bool add(const FrameTracks& tracks, std::span<const ImuSample> imu);

  /// Bias from all rests up to the newest frame, valid at that frame; empty before the first rest.
  std::optional<GyroscopeAtRest> gyroscope() const;

 private:
  struct Point {
    TrackId track;
    Vec3 bearing_C;
  };
  struct Picture {
    Time time;
    std::vector<Point> points;  ///< of the first camera, by track
    Vec3 sum_of_rates_B = Vec3::Zero();
    int readings = 0;  ///< since the image before
  };

  bool readingsRest(std::span<const ImuSample> imu, Picture* picture);
  /// Largest common shift of the images over `span_s`, rad; empty where that is more than noise.
  std::optional<double> shiftAtRest() const;
  void learnBias(double shift_rad);

  RestOptions options_;
  ImuNoise noise_;
  double focal_length_px_;
  RestDetector readings_;
  std::optional<Time> last_reading_;
  std::deque<Picture> pictures_;  ///< over `span_s`
  std::optional<Time> last_rest_;
  Vec3 bias_B_ = Vec3::Zero();
  double bias_variance_ = 0.0;  ///< at the last rest
};

}  // namespace lodeline
