#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/frontend/detection/image_quality.h"
#include "lodeline/inspection/survey/stream_survey.h"
#include "lodeline/inspection/survey/turn_comparison.h"
#include "lodeline/io/synchronizer/measurement_source.h"
#include "lodeline/util/diagnostics.h"

namespace lodeline {

/// A stretch of a recording.
struct SurveySpan {
  Time begin, end;
};

/// One image that was looked at.
struct FrameSurvey {
  Time time;
  ImageQuality quality;
  int corners = 0;    ///< that are worth following
  int followed = -1;  ///< of the corners of the image before; -1 where that was not looked at
};

/// What the images of one camera look like.
struct CameraSurvey {
  std::string name;
  StreamSummary stream;
  std::vector<FrameSurvey> frames;
  std::vector<CameraTurn> turns;
  int unreadable = 0;
  std::string first_problem;
  int identical = 0;  ///< images with the same pixels as the one before, in stretches in which the rig turns
  int compared = 0;   ///< with the one before, in such stretches
  std::optional<Time> first_identical;
  int other_size = 0;                           ///< images of another size than the calibration's
  int other_width_px = 0, other_height_px = 0;  ///< the first such size
};

struct CameraSurveyOptions {
  int most_turns = 160;         ///< images followed to the next, over all spans
  int most_samples = 60;        ///< images looked at besides, spread over the recording
  double least_step_s = 0.045;  ///< between images that are followed
  /// From one followed pair of images to the next; 0 where each image is followed to the next.
  double pair_interval_s = 0.0;
};

/// Stamps of a camera's images, which are not decoded. Reports what their order tells, as OrderedStream does.
StreamSummary surveyStamps(MeasurementSource* source, size_t camera, Diagnostics* diagnostics);

/// Looks at the images within the spans closely, and at some of the others. `stream`: of the same camera,
/// from surveyStamps(); the source must be a fresh one.
CameraSurvey surveyCamera(MeasurementSource* source, size_t camera, const StreamSummary& stream,
                          const std::vector<SurveySpan>& spans, const CameraSurveyOptions& options);

/// The stretches of `span_s` in which the rig turned most variedly, at most `total_s` together, within the
/// images of a camera. In order of time.
std::vector<SurveySpan> liveliestSpans(const std::vector<ImuSample>& samples, const StreamSummary& images,
                                       double span_s, double total_s);

}  // namespace lodeline
