#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/frontend/tracking/tracks.h"
#include "lodeline/inspection/survey/stereo_survey.h"
#include "lodeline/io/synchronizer/frame_packet.h"
#include "lodeline/rig.h"

namespace lodeline {

/// Checks whether the images of the secondary cameras match those of camera 0. It compares a pair of images
/// in detail (compareStereo) where few points are matched in a secondary camera, or many fewer than before.
///
/// If left and right are exchanged, the monitor reverses the exchange. While the rig turns, two images of
/// different times sometimes fit the exchanged calibration. So the monitor reverts an exchange that the
/// next comparison contradicts. Afterwards it accepts an exchange only after three comparisons in a row. If
/// the images fit no arrangement of the pair, the monitor does not use the camera until its images fit again.
class StereoMonitor {
 public:
  /// `diagnostics` must outlive the monitor.
  StereoMonitor(const Rig& rig, Diagnostics* diagnostics);

  /// The packet's images in the order of the rig's cameras: reordered where cameras are exchanged, empty
  /// where one is left out.
  std::vector<cv::Mat> arrange(const FramePacket& packet);

  /// Evaluates the tracks of the arranged images. Returns true if the images turn out to be exchanged: the
  /// frame's tracks then mix both cameras and must not be used.
  bool judge(const FramePacket& packet, const std::vector<cv::Mat>& images, const FrameTracks& tracks);

  /// Reports at the end for how long camera 0 was the only usable camera.
  void finish();

 private:
  /// A time span without matches in a secondary camera.
  struct Span {
    Time begin, end;
    double length_s() const { return (end - begin).seconds(); }
  };
  struct Partner {
    std::string name;
    double usual_share = 0.0;  ///< running mean of the share of matched tracks
    int frames = 0;            ///< number of frames in that mean
    bool is_left_out = false;
    int contradictions = 0;  ///< in successive comparisons
    int exchanges = 0;       ///< successive comparisons in which the cameras look exchanged
    std::optional<Time> last_look;
    double wait_s = 0.0;  ///< until the next comparison
    std::vector<PointPair> points;
    Span alone;  ///< present span; empty where there are matches
    bool is_alone = false;
    Span longest;
    int spans = 0;
    double alone_s = 0.0;
  };

  bool isDoubtful(const Partner& partner, int tracks, int matches) const;
  std::optional<StereoSurvey> look(const FramePacket& packet, const std::vector<cv::Mat>& images,
                                   size_t camera);
  bool conclude(const FramePacket& packet, const StereoSurvey& survey, size_t camera);
  bool exchange(const FramePacket& packet, const StereoSurvey& survey);
  void followSpan(Time time, bool is_alone, Partner* partner);
  void close(Partner* partner);

  Rig rig_;
  std::vector<Partner> partners_;      ///< camera 1, 2, ...
  bool is_exchanged_ = false;          ///< the first two cameras
  bool is_exchange_on_trial_ = false;  ///< no comparison has confirmed it yet
  bool was_exchange_wrong_ = false;
  std::optional<Time> first_time_;
  double watched_s_ = 0.0;
  Diagnostics* diagnostics_;
};

}  // namespace lodeline
