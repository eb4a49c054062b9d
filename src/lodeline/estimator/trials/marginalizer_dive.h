#pragma once

#include "lodeline/estimator/initialization/start.h"
#include "lodeline/estimator/trials/test_window.h"
#include "lodeline/estimator/visual/landmarks.h"
#include "lodeline/problem/marginalization/marginalizer.h"

namespace lodeline {

/// A short dive with 40 points per image, for tests of the marginalizer.
inline TestSceneOptions sceneOptions(double duration_s, double frame_rate_hz) {
  TestSceneOptions options;
  options.duration_s = duration_s;
  options.points.tracks = 40;
  options.points.frame_rate_hz = frame_rate_hz;
  return options;
}

inline EstimatorOptions quadraticOptions() {
  EstimatorOptions options;
  options.solver.robust_scale_sigmas = 1e3;  // so that the cost is practically quadratic
  return options;
}

/// Adds the next frame of a scene, each `keyframe_every`th as a keyframe; the first one starts the
/// marginalizer.
inline void addNext(TestWindow& test, TestScene& scene, FrameId keyframe_every, Marginalizer* marginalizer) {
  const FrameId count = test.window.empty() ? 0 : test.window.newest().id + 1;
  Frame& added = test.add(*scene.next(), count % keyframe_every == 0);
  if (count == 0) marginalizer->start(startPrior(added, test.options.initial_state, 0.05));
  createLandmarks(test.window, test.factors, test.options.landmark);
}

}  // namespace lodeline
