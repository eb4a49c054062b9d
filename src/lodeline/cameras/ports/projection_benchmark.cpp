// Time of a projection with its derivative by the point, of a lens alone and behind ports.

#include <benchmark/benchmark.h>

#include <vector>

#include "lodeline/cameras/camera_model.h"

namespace lodeline {
namespace {

CameraCalibration lens() {
  CameraCalibration c;
  c.name = "cam0";
  c.width_px = 752;
  c.height_px = 480;
  c.fx_px = c.fy_px = 400.0;
  c.cx_px = 370.0;
  c.cy_px = 245.0;
  c.model = "radial-tangential";
  c.distortion = {-0.172, 0.058, 3e-4, -2e-4};
  return c;
}

CameraCalibration behindPlate() {
  CameraCalibration c = lens();
  c.port = Port{.normal_C = Vec3(0.014, -0.01, 1.0).normalized(), .distance_m = 0.015, .thickness_m = 0.008};
  return c;
}

CameraCalibration behindDome() {
  CameraCalibration c = lens();
  c.port = Port{.type = Port::Type::Dome,
                .centre_C = Vec3(0.001, -0.002, 0.004),
                .radius_m = 0.05,
                .thickness_m = 0.006};
  return c;
}

void project(benchmark::State& state, const CameraCalibration& calibration) {
  const auto camera = makeCamera(calibration);
  std::vector<Vec3> points_C;
  for (int i = 0; i < 200; ++i)
    points_C.push_back((0.5 + 0.03 * i) * Vec3(-0.5 + 0.005 * i, 0.3 - 0.0029 * (i * 7 % 200), 1.0));
  Mat23 by_point;
  for (auto _ : state) {
    for (const Vec3& point_C : points_C) {
      benchmark::DoNotOptimize(camera->project(point_C, &by_point));
      benchmark::DoNotOptimize(by_point);
    }
  }
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(points_C.size()));
}

void unproject(benchmark::State& state, const CameraCalibration& calibration) {
  const auto camera = makeCamera(calibration);
  for (auto _ : state) {
    for (int x = 20; x < 740; x += 40) benchmark::DoNotOptimize(camera->viewRay(Vec2(x, 0.6 * x)));
  }
  state.SetItemsProcessed(state.iterations() * 18);
}

BENCHMARK_CAPTURE(project, lens, lens());
BENCHMARK_CAPTURE(project, flat_port, behindPlate());
BENCHMARK_CAPTURE(project, dome_port, behindDome());
BENCHMARK_CAPTURE(unproject, lens, lens());
BENCHMARK_CAPTURE(unproject, flat_port, behindPlate());
BENCHMARK_CAPTURE(unproject, dome_port, behindDome());

}  // namespace
}  // namespace lodeline
