#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "lodeline/cameras/camera.h"
#include "lodeline/frontend/detection/corner_detector.h"
#include "lodeline/frontend/detection/image_quality.h"
#include "lodeline/frontend/detection/static_image_mask.h"
#include "lodeline/frontend/stereo/stereo_matcher.h"
#include "lodeline/frontend/tracking/temporal_tracker.h"
#include "lodeline/frontend/tracking/tracks.h"
#include "lodeline/frontend/tracking/two_point_ransac.h"

namespace lodeline {

struct FrontEndOptions {
  int pyramid_levels = 4;
  CornerDetectorOptions detector;
  TemporalTrackerOptions tracker;
  StereoMatcherOptions stereo;
  TwoPointRansacOptions consensus;
  StaticImageMaskOptions static_image_mask;
  /// Images whose texture (ImageQuality::texture_grey) is below this are smoothed more before tracking,
  /// because noise has more influence on them.
  double faint_texture_grey = 1.5;
  /// The same holds for images with more than this share of detail on the finest scale
  /// (ImageQuality::sharpness). Mere noise has 0.65, clear images have 0.35 to 0.45.
  double noisy_sharpness = 0.46;
  /// Tracks continue after gaps in the images of camera 0 of at most this length.
  double max_gap_s = 1.0;
  /// Standard deviation of an observation.
  double sigma_px = 1.0;

  /// Throws UsageError where a value is out of its range.
  void check() const;
};

/// Result of one frame's tracking.
struct FrontEndStatistics {
  int kept = 0;      ///< followed from the frame before
  int lost = 0;      ///< not found again, or with too low a correlation
  int rejected = 0;  ///< found, but contradicting the motion of the others, or on top of another track
  int created = 0;
  int matched = 0;       ///< observed in at least one secondary camera
  bool missing = false;  ///< camera 0 gave no image
  ImageQuality image;    ///< of camera 0

  int tracks() const { return kept + created; }
};

/// Extracts feature tracks from images. Points are tracked in camera 0 from frame to frame, with the rotation
/// by the gyroscope as prediction. They are matched with the images of every secondary camera of the same
/// time, if there is one.
class FrontEnd {
 public:
  /// Throws InputError where a camera's calibration or mask cannot be used, or the rig has no camera.
  FrontEnd(const Rig& rig, const FrontEndOptions& options);

  /// Processes the images of one time and returns the observations.
  ///
  /// `images`: one 8-bit grey image per camera of the rig; empty where the camera gave none.
  /// `previous_from_current_B`: rotation of the body between the previous call and this one. `alternative_B`:
  /// another prediction of it, which is used where the images contradict the first. Without an image of
  /// camera 0 there are no observations, and tracks wait for the next one. If `motion` contains another time
  /// for a secondary camera's image, its observations are converted to `time`. Throws InputError where an
  /// image has another size or type than its calibration.
  FrameTracks process(Time time, const std::vector<cv::Mat>& images, const Quat& previous_from_current_B,
                      const Quat& alternative_B, const RigMotion& motion = {});
  FrameTracks process(Time time, const std::vector<cv::Mat>& images, const Quat& previous_from_current_B,
                      const RigMotion& motion = {}) {
    return process(time, images, previous_from_current_B, previous_from_current_B, motion);
  }

  /// Discards all tracks, because the images so far were not those of camera 0.
  void forgetTracks();

  /// Statistics of the last frame.
  const FrontEndStatistics& statistics() const { return statistics_; }
  const std::vector<Track>& tracks() const { return tracks_; }
  const std::vector<std::shared_ptr<const Camera>>& cameras() const { return cameras_; }
  /// Time by which a secondary camera (1, 2, ...) takes its images later than assumed.
  StereoDelay& delay(size_t camera) { return matchers_[camera - 1].delay(); }
  /// Static structures in the images of each camera, in which no points are used.
  const std::vector<StaticImageMask>& fixedStructures() const { return static_image_masks_; }

 private:
  void check(Time time, const std::vector<cv::Mat>& images) const;
  ImagePyramid pyramid(const cv::Mat& image) const;
  void updateQuality(const ImagePyramid& current);
  /// Tracks found in the current image, and their rays in the previous one.
  struct Followed {
    std::vector<Track> tracks;
    std::vector<Vec3> previous_bearings;
  };
  Followed follow(std::vector<Track> tracks, const ImagePyramid& current,
                  const Mat3& current_from_previous_C) const;
  void follow(const ImagePyramid& current, const Mat3& current_from_previous_C, const Mat3& alternative_C);
  void rejectOutliers(const std::vector<Vec3>& previous_bearings, const Mat3& current_from_previous_C,
                      const Mat3& alternative_C);
  void rejectCrowded();
  bool isHidden(size_t camera, const Eigen::Vector2f& pixel) const;
  void detect(const ImagePyramid& current);
  void matchOther(size_t m, const ImagePyramid& current, const ImagePyramid& other);
  void matchOthers(Time time, const ImagePyramid& current, const std::vector<cv::Mat>& images);
  FrameTracks observations(Time time) const;

  FrontEndOptions options_;
  std::vector<std::shared_ptr<const Camera>> cameras_;
  Quat body_from_camera_;
  std::vector<cv::Mat> masks_;
  TemporalTracker tracker_;
  std::vector<StereoMatcher> matchers_;  ///< camera 0 with camera 1, 2, ...
  CornerDetector detector_;
  std::vector<StaticImageMask> static_image_masks_;  ///< of each camera

  std::vector<Track> tracks_;  ///< by rising id
  ImagePyramid previous_;
  bool faint_ = false;  ///< the last image was faint or noisy
  Time previous_time_;
  double previous_interval_s_ = 0.0;  ///< interval between the last two images
  /// Rotations since the last image of camera 0, by both predictions.
  Quat previous_from_current_B_ = Quat::Identity(), alternative_B_ = Quat::Identity();
  TrackId next_id_ = 0;
  FrontEndStatistics statistics_;
};

}  // namespace lodeline
