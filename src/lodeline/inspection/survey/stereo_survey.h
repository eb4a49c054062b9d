#pragma once

#include <optional>
#include <vector>

#include "lodeline/inspection/survey/point_following.h"
#include "lodeline/inspection/survey/stream_survey.h"
#include "lodeline/recording.h"

namespace lodeline {

/// Possible gross errors in the calibration of a pair of cameras.
enum class StereoHypothesis {
  AsCalibrated,
  ImagesExchanged,      ///< the images of both cameras are exchanged
  ExtrinsicsExchanged,  ///< the T_BS of both cameras are exchanged
  ExtrinsicsInverted,   ///< both T_BS are inverted
  BaselineReversed,     ///< the rotations are correct, the direction of the baseline is reversed
};

/// Evaluation of a pair of cameras from images taken at the same time.
struct StereoSurvey {
  double baseline_m = 0.0;  ///< as calibrated
  int images = 0;           ///< pairs of them
  int same = 0;             ///< of these pairs: two copies of one image
  int points = 0;           ///< in both images, and with enough parallax under every hypothesis
  /// Share of these points that are on their epipolar lines and in front of both cameras, as calibrated.
  double agreement = 0.0;
  double best_agreement = 0.0;  ///< with the hypothesis under which it is largest
  /// Hypotheses with (nearly) that share: often more than one, because all of them reverse the baseline.
  std::vector<StereoHypothesis> fitting;
  /// Rotation of the second camera relative to its calibration, rad, as far as epipolar lines show it
  /// (frontend/stereo/stereo_rotation.h); 0 where they need no correction.
  double turn_rad = 0.0;
};

/// Corners of the first image outside `mask`, matched in the second one.
std::vector<PointPair> matchStereo(const cv::Mat& first, const cv::Mat& second, const cv::Mat& mask);

/// Whether two images with corners in common are copies of one: the same brightness, and every corner at the
/// same place.
bool areCopies(const cv::Mat& first, const cv::Mat& second, const std::vector<PointPair>& points);

/// Surveys the first two cameras of the rig, which must be calibrated. `stream`: of the first; the source
/// must be a fresh one. Empty where the images of the cameras are not taken together.
std::optional<StereoSurvey> surveyStereo(MeasurementSource* source, const StreamSummary& stream);

/// Evaluates points in both images, px: the part of surveyStereo() without images.
StereoSurvey compareStereo(const CameraCalibration& first, const CameraCalibration& second,
                           const std::vector<PointPair>& points);

}  // namespace lodeline
