#include <benchmark/benchmark.h>

#include <opencv2/core/utility.hpp>
#include <opencv2/video/tracking.hpp>

#include "lodeline/frontend/front_end.h"
#include "lodeline/frontend/test_accuracy.h"
#include "lodeline/frontend/test_sequence.h"
#include "lodeline/geometry/so3.h"
#include "lodeline/io/euroc/euroc_source.h"
#include "lodeline/io/synchronizer/synchronizer.h"
#include "lodeline/util/files/test_data.h"

namespace lodeline {
namespace {

struct Frame {
  Time time;
  std::vector<cv::Mat> images;
  Quat previous_from_current = Quat::Identity();
};

/// One iteration is one frame: the sequence is repeated, and tracks are kept.
void trackFrames(benchmark::State& state, const Rig& rig, const std::vector<Frame>& frames) {
  cv::setNumThreads(1);
  FrontEnd front_end(rig, {});
  size_t next = 0;
  double tracks = 0.0, matched = 0.0;
  for (auto _ : state) {
    if (next == 0) front_end = FrontEnd(rig, {});
    const Frame& frame = frames[next];
    benchmark::DoNotOptimize(front_end.process(frame.time, frame.images, frame.previous_from_current));
    tracks += front_end.statistics().tracks();
    matched += front_end.statistics().matched;
    next = (next + 1) % frames.size();
  }
  const auto per_frame = benchmark::Counter::kAvgIterations;
  state.counters["tracks"] = benchmark::Counter(tracks, per_frame);
  state.counters["matched"] = benchmark::Counter(matched, per_frame);
}

class OpenCvTracker {
 public:
  explicit OpenCvTracker(const Rig& rig) : camera_(makeCamera(rig.cameras.front())) {}

  FrameTracks process(Time time, const cv::Mat& image, const Quat& previous_from_current_C) {
    std::vector<cv::Mat> pyramid;
    cv::buildOpticalFlowPyramid(image, pyramid, kWindow, kCoarsest);
    if (!points_.empty()) follow(pyramid, previous_from_current_C.conjugate().toRotationMatrix());
    std::vector<Eigen::Vector2f> occupied;
    for (const cv::Point2f& p : points_) occupied.emplace_back(p.x, p.y);
    const CornerDetectorOptions options;
    for (const auto& corner : CornerDetector(options).detect(ImagePyramid(image, 2), {}, occupied)) {
      if (static_cast<int>(points_.size()) >= options.max_tracks) break;
      points_.emplace_back(corner.x(), corner.y());
      ids_.push_back(next_id_++);
    }
    pyramid_ = std::move(pyramid);
    FrameTracks result{time, {}};
    for (size_t i = 0; i < points_.size(); ++i) {
      result.observations.push_back({ids_[i], 0, Vec2(points_[i].x, points_[i].y)});
    }
    return result;
  }

 private:
  void follow(const std::vector<cv::Mat>& pyramid, const Mat3& current_from_previous_C) {
    const cv::TermCriteria stop(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 30, 0.01);
    std::vector<cv::Point2f> found = points_, back = points_;
    for (cv::Point2f& p : found) {
      const Vec2 pixel = *camera_->project(current_from_previous_C * *camera_->unproject(Vec2(p.x, p.y)));
      p = cv::Point2f(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
    }
    std::vector<uint8_t> forward, backward;
    cv::calcOpticalFlowPyrLK(pyramid_, pyramid, points_, found, forward, cv::noArray(), kWindow, kCoarsest,
                             stop, cv::OPTFLOW_USE_INITIAL_FLOW);
    cv::calcOpticalFlowPyrLK(pyramid, pyramid_, found, back, backward, cv::noArray(), kWindow, 1, stop,
                             cv::OPTFLOW_USE_INITIAL_FLOW);
    size_t kept = 0;
    for (size_t i = 0; i < points_.size(); ++i) {
      const bool good = forward[i] && backward[i] && cv::norm(back[i] - points_[i]) < 1.0 &&
                        camera_->contains(Vec2(found[i].x, found[i].y), 8.0);
      if (!good) continue;
      points_[kept] = found[i];
      ids_[kept++] = ids_[i];
    }
    points_.resize(kept);
    ids_.resize(kept);
  }

  static constexpr int kCoarsest = 3;
  inline static const cv::Size kWindow{21, 21};
  std::shared_ptr<const Camera> camera_;
  std::vector<cv::Mat> pyramid_;
  std::vector<cv::Point2f> points_;
  std::vector<TrackId> ids_;
  TrackId next_id_ = 0;
};

std::vector<Frame> render(const TestSequence& sequence) {
  std::vector<Frame> frames;
  for (int i = 0; i < 20; ++i) {
    const Quat rotation = i > 0 ? sequence.previousFromCurrent(i) : Quat::Identity();
    frames.push_back({TestSequence::time(i), sequence.images(i), rotation});
  }
  return frames;
}

void reportAccuracy(benchmark::State& state, const TestSequence& sequence,
                    const std::vector<FrameTracks>& tracks) {
  const TrackAccuracy accuracy = accuracyOverTenFrames(sequence, tracks);
  state.counters["after10_survived"] = accuracy.survived;
  state.counters["after10_rms_px"] = accuracy.rms_px;
  state.counters["after10_bias_px"] = accuracy.bias_px.norm();
}

void renderedStereoFrame(benchmark::State& state, const TestLight& light) {
  const TestSequence sequence(light);
  const std::vector<Frame> frames = render(sequence);
  trackFrames(state, sequence.rig(), frames);
  FrontEnd front_end(sequence.rig(), {});
  std::vector<FrameTracks> tracks;
  for (const Frame& f : frames)
    tracks.push_back(front_end.process(f.time, f.images, f.previous_from_current));
  reportAccuracy(state, sequence, tracks);
}

/// For comparison: OpenCV's tracker on the left images alone, with the same corners, prediction and
/// forward-backward check.
void renderedLeftFrameOpenCv(benchmark::State& state, const TestLight& light) {
  cv::setNumThreads(1);
  const TestSequence sequence(light);
  const std::vector<Frame> frames = render(sequence);
  std::vector<FrameTracks> tracks;
  OpenCvTracker tracker(sequence.rig());
  for (auto _ : state) {
    if (tracks.size() == frames.size()) {
      tracks.clear();
      tracker = OpenCvTracker(sequence.rig());
    }
    const Frame& f = frames[tracks.size()];
    tracks.push_back(tracker.process(f.time, f.images.front(), f.previous_from_current));
  }
  while (tracks.size() < frames.size()) {
    const Frame& f = frames[tracks.size()];
    tracks.push_back(tracker.process(f.time, f.images.front(), f.previous_from_current));
  }
  reportAccuracy(state, sequence, tracks);
}

void recordedStereoFrame(benchmark::State& state) {
  const std::optional<std::filesystem::path> recording = testData(kMh01Recording);
  if (!recording) {
    state.SkipWithError(missingTestData(kMh01Recording).c_str());
    return;
  }
  Diagnostics diagnostics;
  EurocSource source(*recording, {}, &diagnostics);
  SynchronizerOptions options;
  options.duration_s = 5.0;
  Synchronizer synchronizer(&source, options, &diagnostics);
  std::vector<Frame> frames;
  while (auto packet = synchronizer.next()) {
    Frame frame{packet->time, std::move(packet->images)};
    for (size_t i = 1; i < packet->imu.size() && !frames.empty(); ++i) {
      const double dt = (packet->imu[i].time - packet->imu[i - 1].time).seconds();
      frame.previous_from_current =
          frame.previous_from_current * so3::exp(dt * packet->imu[i].angular_velocity_B);
    }
    frames.push_back(std::move(frame));
  }
  trackFrames(state, source.rig(), frames);
}

BENCHMARK_CAPTURE(renderedStereoFrame, daylight, TestLight::daylight())->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(renderedStereoFrame, dim_lamp, TestLight::dimLamp())->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(renderedStereoFrame, hazy_lamp, TestLight::hazyLamp())->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(renderedLeftFrameOpenCv, daylight, TestLight::daylight())->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(renderedLeftFrameOpenCv, dim_lamp, TestLight::dimLamp())->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(renderedLeftFrameOpenCv, hazy_lamp, TestLight::hazyLamp())->Unit(benchmark::kMillisecond);
BENCHMARK(recordedStereoFrame)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lodeline
