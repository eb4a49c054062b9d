#include "lodeline/batch/batch_structure.h"

#include <gtest/gtest.h>

#include "lodeline/estimator/trials/test_window.h"
#include "lodeline/geometry/so3.h"

namespace lodeline {
namespace {

// An error in a landmark's position widens the robust losses of all its frames. With intrinsics that the run
// found to be wrong, batches gave weight to observations that slide.
TEST(PlaceLandmark, PutsItWhereTheLensOfTheRunSeesIt) {
  const TestWindow::Lens lens = {0.006, -0.004, 2.5, -1.5, 0.008, -0.01, 0.002, -0.001, 0.0, 0.0};
  const Vec3 point_W(3.0, -0.9, 0.4);
  TestWindow test;
  test.calibrate(lens);
  for (int i = 0; i < 6; ++i) {
    const Frame& frame =
        test.add(Rigid3(so3::exp(Vec3(0.01 * i, 0, 0.05 * i)), Vec3(0.1 * i, -0.2 * i, 0.02 * i)));
    for (int camera = 0; camera < 2; ++camera) test.seeThrough(lens, 1, point_W, frame, camera);
  }
  FeatureTrack& track = test.window.tracks().at(1);
  placeLandmark(test.window, test.factors, test.options.landmark, &track);
  ASSERT_TRUE(track.landmark.has_value());
  EXPECT_LT((test.position(1) - point_W).norm(), 0.002);
  for (const Vec2& residual_px : residualsOf(test.factors.landmark(test.window, track)))
    EXPECT_LT(residual_px.norm(), 0.05);
}

}  // namespace
}  // namespace lodeline
