#pragma once

#include <optional>
#include <vector>

#include "lodeline/inspection/survey/point_following.h"
#include "lodeline/inspection/survey/stream_survey.h"
#include "lodeline/io/synchronizer/measurement_source.h"

namespace lodeline {

/// How the calibration of a pair of cameras may be wrong as a whole.
enum class StereoHypothesis {
  AsCalibrated,
  ImagesExchanged,      ///< each camera's images are the other's
  ExtrinsicsExchanged,  ///< each camera's T_BS is the other's
  ExtrinsicsInverted,   ///< both T_BS are given the wrong way round
  BaselineReversed,     ///< the rotations are right, the way from one camera to the other is not
};

/// What images taken at the same time say of a pair of cameras.
struct StereoSurvey {
  double baseline_m = 0.0;  ///< as calibrated
  int images = 0;           ///< pairs of them
  int points = 0;           ///< in both, and near enough to have parallax whichever hypothesis holds
  /// Share of these that lie on their epipolar lines and in front of both cameras, as calibrated.
  double agreement = 0.0;
  double best_agreement = 0.0;  ///< under the hypothesis under which most do
  /// The hypotheses under which (nearly) as many do: often more than one, as all of them turn the baseline.
  std::vector<StereoHypothesis> fitting;
  /// By which the second camera is turned against its calibration, rad, as far as epipolar lines show it
  /// (features/stereo_rotation.h); 0 where they need no turn.
  double turn_rad = 0.0;
};

/// Corners of the first image outside of `mask`, found in the second one.
std::vector<PointPair> matchStereo(const cv::Mat& first, const cv::Mat& second, const cv::Mat& mask);

/// Looks at the first two cameras of the rig, which must be calibrated. `stream`: of the first; the source
/// must be a fresh one. Nothing where the cameras' images are not taken together.
std::optional<StereoSurvey> surveyStereo(MeasurementSource* source, const StreamSummary& stream);

/// Judges the points of both images, px: the part of surveyStereo() that needs no images.
StereoSurvey compareStereo(const CameraCalibration& first, const CameraCalibration& second,
                           const std::vector<PointPair>& points);

}  // namespace lodeline
