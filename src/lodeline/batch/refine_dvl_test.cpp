#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "lodeline/batch/refine.h"
#include "lodeline/estimator/dvl/dvl_fusion.h"
#include "lodeline/estimator/trials/scene_dvl.h"

namespace lodeline {
namespace {

enum class DvlReadings { None, Bottom, Water };

/// A run with a DVL, or without its readings, through eight seconds of darkness.
struct DvlRun {
  Refinement refinement;
  std::vector<Comparison> comparisons;
  double scale = 0.0;  ///< of the DVL, at the end of the forward run

  explicit DvlRun(DvlReadings readings) {
    TestSceneOptions scene_options;
    scene_options.duration_s = 24.0;
    scene_options.points.tracks = 40;
    scene_options.points.frame_rate_hz = 8.0;
    scene_options.points.blackouts = {{10.0, 8.0}};
    TestScene scene(scene_options);
    Rig rig = scene.rig();
    rig.dvl = SceneDvl::lookingDown();
    EstimatorOptions options = honestOptions(scene_options);
    options.camera_calibration.enabled = false;
    Diagnostics diagnostics;
    Estimator estimator(rig, options, &diagnostics);
    EstimatorLog record;
    SceneDvlErrors errors;
    errors.scale = 0.01;
    if (readings == DvlReadings::Water) errors.current_W = [](double) { return Vec3(0.2, -0.1, 0.0); };
    SceneDvl dvl(scene, *rig.dvl, scene_options, errors);
    TruthComparison truth;
    while (const auto frame = scene.next()) {
      std::vector<DvlSample> pings = dvl.until(frame->truth.time);
      if (readings == DvlReadings::None) pings.clear();
      const FrameEstimate estimate =
          estimator.add(frame->tracks, frame->imu, SensorReadings(std::move(pings)));
      record.add(frame->tracks, frame->imu, estimate, estimator);
      Comparison comparison = truth.compare(*frame, estimate, estimator);
      comparison.time_s = scene.secondsOf(frame->truth.time);
      if (comparison.initialized()) comparisons.push_back(comparison);
      scale = estimate.sensors.of<DvlEstimate>().scale;
    }
    record.finish(estimator);
    refinement = refine(rig, options, record);
  }

  /// In the dark.
  double rootMeanSquare(bool is_refined) const {
    double sum = 0.0;
    int count = 0;
    for (size_t i = 0; i < comparisons.size(); ++i) {
      const Comparison& c = comparisons[i];
      if (c.time_s < 10.0 || c.time_s > 18.0) continue;
      const FrameEstimate& estimate = is_refined ? refinement.frames[i] : c.estimate;
      sum += (estimate.state.world_from_body.translation - c.true_world_from_body.translation).squaredNorm();
      ++count;
    }
    return std::sqrt(sum / count);
  }
};

TEST(RefineDvl, BatchSolutionUsesTheVelocities) {
  const DvlRun with(DvlReadings::Bottom), without(DvlReadings::None);
  for (const DvlRun* run : {&with, &without}) {
    ASSERT_TRUE(run->refinement.summary.usable()) << run->refinement.summary.refusal;
    ASSERT_EQ(run->refinement.frames.size(), run->comparisons.size());
  }
  EXPECT_NEAR(with.scale, 0.01, 0.003);
  EXPECT_LT(with.rootMeanSquare(true), 1.5 * with.rootMeanSquare(false));
  EXPECT_LT(with.rootMeanSquare(true), 0.8 * without.rootMeanSquare(true));
  EXPECT_LT(with.rootMeanSquare(true), 0.05);
  RecordProperty("with", std::to_string(with.rootMeanSquare(true)));
  RecordProperty("without", std::to_string(without.rootMeanSquare(true)));
}

TEST(RefineDvl, BatchSolutionUsesVelocitiesThroughTheWater) {
  const DvlRun water(DvlReadings::Water), without(DvlReadings::None);
  ASSERT_TRUE(water.refinement.summary.usable()) << water.refinement.summary.refusal;
  RecordProperty("water_forward", std::to_string(water.rootMeanSquare(false)));
  RecordProperty("water", std::to_string(water.rootMeanSquare(true)));
  RecordProperty("without", std::to_string(without.rootMeanSquare(true)));
  EXPECT_LT(water.rootMeanSquare(true), water.rootMeanSquare(false));
  EXPECT_LT(water.rootMeanSquare(true), without.rootMeanSquare(true));
}

}  // namespace
}  // namespace lodeline
