#include <benchmark/benchmark.h>

#include <array>
#include <opencv2/core/utility.hpp>

#include "lodeline/base/test_data.h"
#include "lodeline/data/euroc_source.h"
#include "lodeline/data/synchronizer.h"
#include "lodeline/features/front_end.h"
#include "lodeline/features/test_sequence.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

struct Frame {
  Time time;
  std::vector<cv::Mat> images;
  Quat previous_from_current = Quat::Identity();
};

/// One iteration is one frame: the sequence is run from its start again and again, tracks kept.
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

void renderedStereoFrame(benchmark::State& state, const TestLight& light) {
  const TestSequence sequence(light);
  std::vector<Frame> frames;
  for (int i = 0; i < 20; ++i) {
    const Quat rotation = i > 0 ? sequence.previousFromCurrent(i) : Quat::Identity();
    frames.push_back({TestSequence::time(i), sequence.images(i), rotation});
  }
  trackFrames(state, sequence.rig(), frames);
}

void recordedStereoFrame(benchmark::State& state) {
  const auto folder = testDataDir();
  if (!folder || !std::filesystem::exists(*folder / "euroc_mh01_stereo_14s")) {
    state.SkipWithError("recording euroc_mh01_stereo_14s not found; set LODELINE_DATA_DIR");
    return;
  }
  Diagnostics diagnostics;
  EurocSource source(*folder / "euroc_mh01_stereo_14s", {}, &diagnostics);
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
BENCHMARK(recordedStereoFrame)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace lodeline
