#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/frontend/tracking/tracks.h"
#include "lodeline/inspection/survey/stereo_survey.h"
#include "lodeline/io/synchronizer/frame_packet.h"
#include "lodeline/sensors/rig.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// Watches whether the images of the secondary cameras belong to those of the first one. Where few points are
/// matched in a secondary camera, or many fewer than before, a pair of images is looked at closely
/// (compareStereo): left and right may be exchanged, from the start or from some moment on, which is undone;
/// or the images fit no arrangement of the pair, and the camera is left out until they fit again.
class StereoMonitor {
 public:
  /// `diagnostics` must outlive the watch.
  StereoMonitor(const Rig& rig, Diagnostics* diagnostics);

  /// The packet's images as the cameras of the rig took them: put back where cameras are exchanged, empty
  /// where one is left out.
  std::vector<cv::Mat> arrange(const FramePacket& packet);

  /// Judges what the front end made of the arranged images. True where they turn out to be exchanged: the
  /// frame's tracks mix both cameras and must not be used.
  bool judge(const FramePacket& packet, const std::vector<cv::Mat>& images, const FrameTracks& tracks);

  /// Says how long the first camera was alone; at the end.
  void finish();

 private:
  /// A stretch in which a secondary camera gave nothing.
  struct Span {
    Time begin, end;
    double length_s() const { return (end - begin).seconds(); }
  };
  struct Partner {
    std::string name;
    double usual_share = 0.0;  ///< of the tracks that are matched, in the mean
    int frames = 0;            ///< that it was taken over
    bool is_left_out = false;
    int contradictions = 0;  ///< looks in a row
    std::optional<Time> last_look;
    double wait_s = 0.0;  ///< before the next look
    std::vector<PointPair> points;
    Span alone;  ///< at present; empty where it is not
    bool is_alone = false;
    Span longest;
    int spans = 0;
    double alone_s = 0.0;
  };

  bool isDoubtful(const Partner& partner, int tracks, int matches) const;
  std::optional<StereoSurvey> look(const FramePacket& packet, const std::vector<cv::Mat>& images,
                                   size_t camera);
  bool conclude(const FramePacket& packet, const StereoSurvey& survey, size_t camera);
  void followSpan(Time time, bool is_alone, Partner* partner);
  void close(Partner* partner);

  Rig rig_;
  std::vector<Partner> partners_;  ///< camera 1, 2, ...
  bool is_exchanged_ = false;      ///< the first two cameras
  std::optional<Time> first_time_;
  double watched_s_ = 0.0;
  Diagnostics* diagnostics_;
};

}  // namespace lodeline
