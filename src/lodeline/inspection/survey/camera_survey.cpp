#include "lodeline/inspection/survey/camera_survey.h"

#include <algorithm>
#include <cstring>
#include <opencv2/core.hpp>

#include "lodeline/cameras/camera.h"
#include "lodeline/frontend/detection/corner_detector.h"
#include "lodeline/frontend/detection/mask.h"
#include "lodeline/inspection/survey/camera_words.h"
#include "lodeline/inspection/survey/point_following.h"
#include "lodeline/inspection/survey/visual_rotation.h"
#include "lodeline/io/streams/ordered_stream.h"

namespace lodeline {
namespace {

constexpr double kImageGapPeriods = 1.5;
constexpr int kPyramidLevels = 4;

bool isWithin(Time time, const std::vector<SurveySpan>& spans) {
  return std::any_of(spans.begin(), spans.end(),
                     [&](const SurveySpan& span) { return time >= span.begin && time <= span.end; });
}

/// An image with its corners, to be tracked into the next.
struct Followed {
  Time time;
  cv::Mat image;
  std::vector<cv::Point2f> corners;
};

class Survey {
 public:
  Survey(const CameraCalibration& calibration, const CameraSurveyOptions& options, CameraSurvey* result)
      : options_(options),
        offset_(Duration::fromSeconds(calibration.time_offset_to_imu_s)),
        calibration_(calibration),
        camera_(isCalibrated(calibration) ? makeCamera(calibration) : nullptr),
        mask_(loadMask(calibration)),
        detector_(CornerDetectorOptions()),
        result_(result) {}

  void look(const PendingImage& pending, bool follow) {
    const LoadedImage loaded = pending.load();
    if (loaded.image.empty()) {
      if (result_->unreadable++ == 0) result_->first_problem = loaded.problem;
      return;
    }
    if (!hasRightSize(loaded.image)) return;
    if (follow && previous_ && options_.pair_interval_s > 0.0) return endPair(pending.time, loaded.image);
    const ImagePyramid pyramid(loaded.image, kPyramidLevels);
    Followed current{pending.time, loaded.image, {}};
    for (const Eigen::Vector2f& corner : detector_.detect(pyramid, mask_, {})) {
      current.corners.emplace_back(corner.x(), corner.y());
    }
    FrameSurvey frame{pending.time, assess(pyramid), static_cast<int>(current.corners.size()), -1};
    if (follow && previous_) compare(current, &frame);
    result_->frames.push_back(frame);
    previous_.reset();
    if (follow) previous_ = std::move(current);
  }

  /// Whether the next image comes too soon after the last tracked one.
  bool isTooSoon(Time time) const {
    if (!previous_ && next_pair_ && time < *next_pair_) return true;
    return previous_ && time > previous_->time && (time - previous_->time).seconds() < options_.least_step_s;
  }

  /// Whether an image has the same stored bytes as the one before; this is much cheaper than decoding both. A
  /// repeated image shows the time of the image before, so later images must be compared with that.
  bool repeats(const PendingImage& pending) {
    if (!pending.stored) return false;
    StoredImage image = pending.stored();
    if (!image.problem.empty()) return false;
    const bool is_repeat = before_ && isSame(image, *before_);
    result_->compared += before_ ? 1 : 0;
    before_ = std::move(image);
    if (!is_repeat) return false;
    if (result_->identical++ == 0) result_->first_identical = pending.time;
    return true;
  }

 private:
  /// Tracks points into the second image of a pair, for the rotation only.
  void endPair(Time time, const cv::Mat& image) {
    FrameSurvey unused;
    compare({time, image, {}}, &unused);
    next_pair_ = previous_->time + Duration::fromSeconds(options_.pair_interval_s);
    previous_.reset();
  }

  static bool isSame(const StoredImage& a, const StoredImage& b) {
    if (a.pixels.empty() || b.pixels.empty()) return a.file == b.file && !a.file.empty();
    if (a.pixels.size() != b.pixels.size() || a.pixels.type() != b.pixels.type()) return false;
    const size_t row_bytes = a.pixels.elemSize() * static_cast<size_t>(a.pixels.cols);
    for (int row = 0; row < a.pixels.rows; ++row) {
      if (std::memcmp(a.pixels.ptr(row), b.pixels.ptr(row), row_bytes) != 0) return false;
    }
    return true;
  }

  bool hasRightSize(const cv::Mat& image) {
    if (!camera_) return true;
    if (image.cols == calibration_.width_px && image.rows == calibration_.height_px) return true;
    if (result_->other_size++ == 0) {
      result_->other_width_px = image.cols;
      result_->other_height_px = image.rows;
    }
    return false;
  }

  void compare(const Followed& current, FrameSurvey* frame) {
    if (previous_->image.size() != current.image.size()) return;
    constexpr double kLongestStep_s = 0.3;
    const double step_s = (current.time - previous_->time).seconds();
    if (previous_->corners.empty() || !(step_s > 0.0) || step_s > kLongestStep_s) return;
    const std::vector<PointPair> points = followPoints(previous_->image, current.image, previous_->corners);
    frame->followed = static_cast<int>(points.size());
    if (!camera_) return;
    std::vector<Vec3> before, after;
    for (const PointPair& point : points) {
      const std::optional<Vec3> ray_before = camera_->unproject(point.first);
      const std::optional<Vec3> ray_after = camera_->unproject(point.second);
      if (!ray_before || !ray_after) continue;
      before.push_back(*ray_before);
      after.push_back(*ray_after);
    }
    const std::optional<VisualRotation> rotation = visualRotation(before, after);
    result_->pairs.push_back(
        {previous_->time + offset_, current.time + offset_, std::move(before), std::move(after)});
    if (!rotation) return;
    result_->turns.push_back(
        {previous_->time + offset_, current.time + offset_, Vec3(rotation->rotation_C / step_s)});
  }

  CameraSurveyOptions options_;
  Duration offset_;
  const CameraCalibration& calibration_;
  std::shared_ptr<const Camera> camera_;  ///< null where the camera is not calibrated
  cv::Mat mask_;
  CornerDetector detector_;
  CameraSurvey* result_;
  std::optional<Followed> previous_;
  std::optional<Time> next_pair_;
  std::optional<StoredImage> before_;  ///< the image before, in the tracked spans
};

/// Amount of varied rotation in each span; readings in order of time.
std::vector<std::pair<double, SurveySpan>> rateSpans(const std::vector<ImuSample>& samples,
                                                     const StreamSummary& images, double span_s) {
  std::vector<std::pair<double, SurveySpan>> spans;
  const Duration length = Duration::fromSeconds(span_s);
  auto sample = samples.begin();
  for (Time begin = *images.first; begin < *images.last; begin = begin + length) {
    const SurveySpan span{begin, begin + length};
    Vec3 sum = Vec3::Zero(), squares = Vec3::Zero();
    double count = 0.0;
    while (sample != samples.end() && sample->time < begin) ++sample;
    for (; sample != samples.end() && sample->time < span.end; ++sample) {
      sum += sample->angular_velocity_B;
      squares += sample->angular_velocity_B.cwiseAbs2();
      ++count;
    }
    if (count > 2.0) spans.emplace_back((squares / count - (sum / count).cwiseAbs2()).sum(), span);
  }
  return spans;
}

}  // namespace

StreamSummary surveyStamps(MeasurementSource* source, size_t camera, Diagnostics* diagnostics) {
  constexpr size_t kImagesAhead = 8;
  const CameraCalibration& calibration = source->rig().cameras[camera];
  StreamSurvey stream;
  const int jumps_before = diagnostics->count("image_clock_jump");
  StreamExpectation expected{"image", calibration.name, calibration.rate_hz, 0.0, Duration()};
  expected.look_ahead = kImagesAhead;
  const auto pull = [&] {
    std::optional<PendingImage> image = source->nextImage(camera);
    if (image) stream.add(image->time);
    return image;
  };
  OrderedStream<PendingImage> ordered(expected, pull, diagnostics);
  while (ordered.peek() != nullptr) ordered.pop();
  StreamSummary summary = stream.summarize(kImageGapPeriods);
  summary.clock_jumps = diagnostics->count("image_clock_jump") - jumps_before;
  return summary;
}

CameraSurvey surveyCamera(MeasurementSource* source, size_t camera, const StreamSummary& stream,
                          const std::vector<SurveySpan>& spans, const CameraSurveyOptions& options) {
  const CameraCalibration& calibration = source->rig().cameras[camera];
  CameraSurvey result;
  result.name = calibration.name;
  result.stream = stream;
  Survey survey(calibration, options, &result);
  const int64_t every = std::max<int64_t>(1, stream.readings / options.most_samples);
  int64_t index = 0;
  int followed = 0;
  while (const std::optional<PendingImage> image = source->nextImage(camera)) {
    const bool follow = followed < options.most_turns && isWithin(image->time, spans);
    const bool sample = index++ % every == 0;
    if (follow && (survey.repeats(*image) || survey.isTooSoon(image->time))) continue;
    if (!follow && !sample) continue;
    survey.look(*image, follow);
    if (follow) ++followed;
  }
  return result;
}

std::vector<SurveySpan> liveliestSpans(const std::vector<ImuSample>& samples, const StreamSummary& images,
                                       double span_s, double total_s) {
  std::vector<SurveySpan> chosen;
  if (!images.first || samples.empty()) return chosen;
  std::vector<std::pair<double, SurveySpan>> spans = rateSpans(samples, images, span_s);
  std::stable_sort(spans.begin(), spans.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  // The best span of each half comes first, so that changes during the recording are detected.
  const Time middle = *images.first + Duration::fromSeconds(0.5 * images.duration_s);
  const auto startsLate = [&](const auto& span) { return span.second.begin >= middle; };
  if (!spans.empty()) {
    const bool is_late = startsLate(spans.front());
    const auto other = std::find_if(spans.begin(), spans.end(),
                                    [&](const auto& span) { return startsLate(span) != is_late; });
    if (other != spans.end()) std::rotate(spans.begin() + 1, other, other + 1);
  }
  for (size_t i = 0; i < spans.size() && static_cast<double>(i) * span_s < total_s; ++i) {
    chosen.push_back(spans[i].second);
  }
  std::sort(chosen.begin(), chosen.end(),
            [](const SurveySpan& a, const SurveySpan& b) { return a.begin < b.begin; });
  return chosen;
}

}  // namespace lodeline
