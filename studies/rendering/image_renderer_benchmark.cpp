#include <benchmark/benchmark.h>

#include "simulation/rendering/test_render.h"

namespace lodeline {
namespace {

/// Renders 640 x 480 images along a swim at 15 Hz. The CPU time is the sum over all threads; on two idle
/// cores, an image takes half of it.
void renderAlong(benchmark::State& state, const RenderSettings& settings) {
  const ImageRenderer renderer(RenderFixture::shortCave(), RenderFixture::stereoRig(), settings);
  const WorldFromBodyAt motion = RenderFixture::swim(RenderFixture::shortPassage());
  double time_s = 10.0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(renderer.render(0, motion, time_s));
    time_s += 1.0 / 15.0;
  }
}

void BM_RenderClean(benchmark::State& state) { renderAlong(state, RenderSettings::clean()); }
BENCHMARK(BM_RenderClean)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->Iterations(40);

void BM_RenderField(benchmark::State& state) {
  RenderSettings settings = RenderSettings::field();
  settings.water.silt = {{11.0, 5.0, 2.0}};
  renderAlong(state, settings);
}
BENCHMARK(BM_RenderField)->Unit(benchmark::kMillisecond)->MeasureProcessCPUTime()->Iterations(40);

}  // namespace
}  // namespace lodeline
