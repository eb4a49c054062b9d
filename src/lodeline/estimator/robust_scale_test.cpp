#include "lodeline/estimator/robust_scale.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "lodeline/estimator/test_scene.h"
#include "lodeline/estimator/test_window.h"

namespace lodeline {
namespace {

std::vector<double> rayleigh(double sigma, int count, Random* noise) {
  std::vector<double> errors;
  for (int i = 0; i < count; ++i) errors.push_back(sigma * std::hypot(noise->normal(), noise->normal()));
  return errors;
}

/// Errors of which P(r < R) = 1 - (1 + R^2 / width^2)^(-nu / 2).
std::vector<double> heavyTailed(double nu, double width, int count, Random* random) {
  std::vector<double> errors;
  for (int i = 0; i < count; ++i)
    errors.push_back(width * std::sqrt(std::pow(1.0 - random->uniform(), -2.0 / nu) - 1.0));
  return errors;
}

TEST(RobustScale, IsThatOfTheDistributionTheErrorsHave) {
  Random random(1, "robust scale");
  for (const double nu : {4.0, 6.0, 8.0}) {
    const double width = robustScale(heavyTailed(nu, 0.2, 20000, &random), SolverOptions()).value();
    EXPECT_NEAR(width, 0.2, 0.02) << nu;
  }
  // However heavy the tail, not narrower than what four degrees of freedom ask for.
  std::vector<double> errors = heavyTailed(1.0, 0.2, 20000, &random);
  EXPECT_NEAR(robustScale(errors, SolverOptions()).value(), 1.55 * 0.2 * std::sqrt(3.0), 0.02);
}

TEST(RobustScale, OfNormalErrorsIsAsWideAsAllowed) {
  const SolverOptions options;
  Random noise(1, "robust scale");
  std::vector<double> errors = rayleigh(0.1, 3000, &noise);
  const double clean = robustScale(errors, options).value();
  // Median of a Rayleigh distribution: sigma sqrt(2 ln 2).
  EXPECT_NEAR(clean, options.robust_scale_medians * 0.1 * std::sqrt(2.0 * std::log(2.0)), 0.01);
  for (size_t i = 0; i < 600; ++i) errors[i] = 50.0;
  const double spoilt = robustScale(errors, options).value();
  EXPECT_LT(spoilt, 0.8 * clean);
  EXPECT_GT(spoilt, 0.5 * clean);
}

TEST(RobustScale, IsThatOfTheStatedNoiseAtMost) {
  Random noise(2, "robust scale");
  EXPECT_DOUBLE_EQ(robustScale(rayleigh(3.0, 500, &noise), SolverOptions()).value(),
                   SolverOptions().robust_scale_sigmas);
}

TEST(RobustScale, IsNeverWiderThanAskedHoweverLittleThatIs) {
  SolverOptions narrow;
  narrow.robust_scale_sigmas = 0.01;
  EXPECT_DOUBLE_EQ(robustScale(std::vector<double>(500, 1.0), narrow).value(), 0.01);
}

TEST(RobustScale, IsNeverNothing) {
  EXPECT_GT(robustScale(std::vector<double>(500, 0.0), SolverOptions()).value(), 0.0);
}

TEST(RobustScale, StaysWhereFewErrorsTell) {
  EXPECT_FALSE(robustScale({}, SolverOptions()).has_value());
  EXPECT_FALSE(robustScale(std::vector<double>(10, 0.1), SolverOptions()).has_value());
}

// A third of the tracks is found a tenth of a pixel well like all others, but slides to one side by 0.4 px/s,
// as the edge of a shadow does whose lamp moves along. Returns the error of the position in the end, m.
double errorAmongShadows(const SolverOptions& solver, uint64_t seed) {
  constexpr double kFocalLength_px = 458.0, kSlide_px_per_s = 0.4;
  TestSceneOptions scene_options;
  scene_options.seed = seed;
  scene_options.liveliness = 0.3;
  scene_options.points.pixel_sigma_px = 0.1;
  scene_options.points.tracks = 80;
  scene_options.points.frame_rate_hz = 10.0;
  TestScene scene(scene_options);
  EstimatorOptions options = honestOptions(scene_options);
  options.solver = solver;
  ComparedEstimator estimator(scene, options);
  std::map<TrackId, double> first_seen_s;
  Comparison last;
  while (auto frame = scene.next()) {
    const double time_s = scene.secondsOf(frame->truth.time);
    for (Observation& observation : frame->tracks.observations) {
      observation.sigma_px = 1.0;
      const double since_s = time_s - first_seen_s.try_emplace(observation.track, time_s).first->second;
      if (observation.track % 3 != 0) continue;
      observation.bearing_C.x() += kSlide_px_per_s / kFocalLength_px * since_s;
      observation.bearing_C.normalize();
    }
    last = estimator.add(*frame);
  }
  return last.positionError();
}

TEST(RobustScale, LetsShadowsDragTheRigLess) {
  SolverOptions as_stated;
  as_stated.robust_scale_medians = 1e3;
  double measured_m = 0.0, stated_m = 0.0;
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    measured_m += errorAmongShadows(SolverOptions(), seed);
    stated_m += errorAmongShadows(as_stated, seed);
  }
  EXPECT_LT(measured_m, 0.6 * stated_m);
}

TEST(RobustScale, BelongsToAFrame) {
  TestWindow test;
  const SolverOptions options;
  const FrameId calm = test.add(Rigid3(), true).id, shaken = test.add(Rigid3(), true).id,
                unknown = test.add(Rigid3(), false).id;
  adaptRobustScales(test.window,
                    {{calm, std::vector<double>(30, 0.1)},
                     {shaken, std::vector<double>(30, 0.4)},
                     {unknown, std::vector<double>(3, 0.1)}},
                    options);
  EXPECT_DOUBLE_EQ(test.factors.robustScale(*test.window.find(calm)), options.robust_scale_medians * 0.1);
  EXPECT_DOUBLE_EQ(test.factors.robustScale(*test.window.find(shaken)), options.robust_scale_medians * 0.4);
  EXPECT_DOUBLE_EQ(test.factors.robustScale(*test.window.find(unknown)), options.robust_scale_sigmas);
}

}  // namespace
}  // namespace lodeline
