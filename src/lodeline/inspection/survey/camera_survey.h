#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lodeline/diagnostics.h"
#include "lodeline/frontend/detection/image_quality.h"
#include "lodeline/inspection/survey/stream_survey.h"
#include "lodeline/inspection/survey/turn_comparison.h"
#include "lodeline/recording.h"

namespace lodeline {

/// A time span of a recording.
struct SurveySpan {
  Time begin, end;
};

/// Rays of the same points in two images, in camera axes.
struct RayPairs {
  Time begin, end;  ///< stamps of the images, with the time offset of the calibration
  std::vector<Vec3> first, second;
};

/// Survey of one image.
struct FrameSurvey {
  Time time;
  ImageQuality quality;
  int corners = 0;    ///< number of usable corners
  int followed = -1;  ///< number of tracked corners of the image before; -1 where they were not tracked
};

/// Properties of one camera's images.
struct CameraSurvey {
  std::string name;
  StreamSummary stream;
  std::vector<FrameSurvey> frames;
  std::vector<CameraTurn> turns;
  std::vector<RayPairs> pairs;  ///< of the images that were tracked into the next
  int unreadable = 0;
  std::string first_problem;
  int identical = 0;  ///< images with the same pixels as the one before, in spans in which the rig rotates
  int compared = 0;   ///< number of images compared with the one before in these spans
  std::optional<Time> first_identical;
  int other_size = 0;                           ///< images of another size than the calibration's
  int other_width_px = 0, other_height_px = 0;  ///< the first such size
};

struct CameraSurveyOptions {
  int most_turns = 160;         ///< images tracked into the next, over all spans
  int most_samples = 60;        ///< further images analysed, distributed over the recording
  double least_step_s = 0.045;  ///< between images that are tracked
  /// Interval from one tracked pair of images to the next; 0 where each image is tracked into the next.
  double pair_interval_s = 0.0;
};

/// Survey of the time stamps of a camera's images, which are not decoded. Reports errors in their order, as
/// OrderedStream does.
StreamSummary surveyStamps(MeasurementSource* source, size_t camera, Diagnostics* diagnostics);

/// Analyses the images within the spans in detail, and some of the others. `stream`: of the same camera, from
/// surveyStamps(); the source must be a fresh one.
CameraSurvey surveyCamera(MeasurementSource* source, size_t camera, const StreamSummary& stream,
                          const std::vector<SurveySpan>& spans, const CameraSurveyOptions& options);

/// Spans of `span_s` in which the rig rotated about the most varied axes, at most `total_s` in total, within
/// the images of a camera. In order of time.
std::vector<SurveySpan> liveliestSpans(const std::vector<ImuSample>& samples, const StreamSummary& images,
                                       double span_s, double total_s);

}  // namespace lodeline
