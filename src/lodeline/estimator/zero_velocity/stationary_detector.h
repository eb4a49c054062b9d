#pragma once

#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "lodeline/ahrs/rest_detector.h"
#include "lodeline/estimator/options/options.h"
#include "lodeline/frontend/tracking/tracks.h"
#include "lodeline/sensors/rig.h"

namespace lodeline {

/// What rests say of a gyroscope: where nothing turns, it reads its bias.
struct GyroscopeAtRest {
  Vec3 bias_B;  ///< rad/s
  double sigma_rad_per_s;
};

/// Tells when a rig rests: its inertial readings stay close to their means, and its images stay as they are.
/// That tells more than observations do. Points that do not move in the image are as well infinitely far from
/// a rig that glides, which is what one camera makes of them whose speed dead reckoning has got wrong; no
/// cave is as far as that.
class StationaryDetector {
 public:
  StationaryDetector(const Rig& rig, const RestOptions& options);

  /// Frames in order, with the readings since the frame before. True where a frame's velocity is to be
  /// counted as none: once in `RestOptions::span_s` at most, since what is left of motion lasts.
  bool add(const FrameTracks& tracks, std::span<const ImuSample> imu);

  /// From all rests up to the newest frame, as of that frame; nothing before the first.
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
    int readings = 0;  ///< since the picture before
  };

  bool readingsRest(std::span<const ImuSample> imu, Picture* picture);
  /// How far the images may have shifted over `span_s`, rad; nothing where that is more than noise.
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
