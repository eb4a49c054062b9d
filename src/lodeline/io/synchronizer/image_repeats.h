#pragma once

#include <deque>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/ahrs/rest_detector.h"
#include "lodeline/diagnostics.h"
#include "lodeline/io/synchronizer/frame_packet.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Detects images that repeat the last new image of their camera and removes them from their packets. Drivers
/// and converters fill up a frame rate with repeats, and a frozen camera delivers nothing else. A repeat has
/// its own stamp but shows an earlier moment.
///
/// A repeat has the same pixels, which noise excludes for a working camera. Repeats that were encoded again
/// differ slightly: by at most a fifth of the difference between new images of this camera, although the
/// gyroscope measured a rotation of more than 2.5 px. After three such repeats, the fifth alone is the
/// criterion. Only every 16th row is compared while the rows are equal or the difference is small.
///
/// A rendered camera without noise gives equal images at rest. Equal images are observations of a resting
/// rig, and kept, where the inertial readings came to rest with them.
class ImageRepeats {
 public:
  /// `diagnostics` must outlive the object.
  ImageRepeats(const Rig& rig, Diagnostics* diagnostics);

  enum class Reference { New, Repeat, Frozen };

  /// Removes repeats from a packet; call it in order of time. Returns Frozen where the first camera has
  /// delivered only repeats for more than a quarter of a second.
  Reference screen(FramePacket* packet);

  /// Reports repeats up to the end of the recording.
  void finish();

 private:
  /// Consecutive equal images.
  struct Run {
    int images = 0;
    Time first, last;
    Time first_stamp;
    bool is_blank = false;
  };
  struct View {
    std::string name;
    Mat3 camera_from_body = Mat3::Identity();
    double focal_px = 0.0;
    cv::Mat newest;  ///< last new image
    Time newest_time;
    bool ever_changed = false;       ///< whether a second new image arrived
    Vec3 turn_B = Vec3::Zero();      ///< rotation since `newest_time` from the gyroscope, rad
    std::deque<double> differences;  ///< differences between consecutive new images, grey levels
    int near_repeats = 0;            ///< repeats found with the gyroscope
    Run run;
  };

  void follow(const FramePacket& packet);
  bool isRepeat(const cv::Mat& image, View* view) const;
  bool isResting(const View& view) const;
  void close(View* view);

  std::vector<View> views_;
  RestDetector rest_;
  std::optional<Time> last_reading_;
  std::optional<Time> rests_since_;
  std::optional<Time> first_time_;
  Diagnostics* diagnostics_;
};

}  // namespace lodeline
