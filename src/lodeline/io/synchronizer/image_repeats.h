#pragma once

#include <deque>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/ahrs/rest_detector.h"
#include "lodeline/io/synchronizer/frame_packet.h"
#include "lodeline/sensors/rig.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// Finds images that repeat the last new image of their camera: drivers and converters fill up a frame rate
/// with them, and a camera that hangs delivers nothing else. A repeat carries a stamp of its own but shows an
/// earlier moment, so it is taken out of its packet.
///
/// A repeat has the same pixels, which noise makes impossible for a camera that works. Repeats that were
/// encoded once more differ by a little: at most a fifth of what new images of this camera differ by,
/// although the gyroscope turned the camera by more than 2.5 px. Once three such repeats were found, the
/// fifth alone decides. Only rows 16 apart are compared, as long as they are equal or the difference is
/// small.
///
/// A rendered camera without noise gives equal images at rest. Where the inertial readings are at rest as
/// well, and were not before the images became equal, equal images are observations of a rig that rests: they
/// stay.
class ImageRepeats {
 public:
  /// `diagnostics` must outlive the object.
  ImageRepeats(const Rig& rig, Diagnostics* diagnostics);

  enum class Reference { New, Repeat, Frozen };

  /// Takes repeats out of a packet; packets in order of time. Frozen: the first camera has given nothing but
  /// repeats for more than a quarter of a second.
  Reference screen(FramePacket* packet);

  /// Reports repeats up to the end of the recording.
  void finish();

 private:
  /// Equal images in a row.
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
    bool ever_changed = false;       ///< a second new image was seen
    Vec3 turn_B = Vec3::Zero();      ///< since `newest_time`, by the gyroscope, rad
    std::deque<double> differences;  ///< of the latest new images from the ones before, grey levels
    int near_repeats = 0;            ///< found by the gyroscope
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
