#include "lodeline/problem/robust_loss.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "lodeline/estimator/trials/scene.h"
#include "lodeline/estimator/trials/test_window.h"

namespace lodeline {
namespace {

std::vector<double> rayleigh(double sigma, int count, Random* noise) {
  std::vector<double> errors;
  for (int i = 0; i < count; ++i) errors.push_back(sigma * std::hypot(noise->normal(), noise->normal()));
  return errors;
}

/// Errors with P(r < R) = 1 - (1 + R^2 / width^2)^(-nu / 2).
std::vector<double> heavyTailed(double nu, double width, int count, Random* random) {
  std::vector<double> errors;
  for (int i = 0; i < count; ++i)
    errors.push_back(width * std::sqrt(std::pow(1.0 - random->uniform(), -2.0 / nu) - 1.0));
  return errors;
}

TEST(RobustLoss, IsThatOfTheDistributionTheErrorsHave) {
  Random random(1, "robust scale");
  for (const double nu : {4.0, 6.0, 8.0}) {
    const double width = frameErrors(heavyTailed(nu, 0.2, 20000, &random), SolverOptions()).value().width;
    EXPECT_NEAR(width, 0.2, 0.02) << nu;
  }
  // For any heavy tail, the loss is not narrower than that of four degrees of freedom.
  std::vector<double> errors = heavyTailed(1.0, 0.2, 20000, &random);
  EXPECT_NEAR(frameErrors(errors, SolverOptions()).value().width, 1.55 * 0.2 * std::sqrt(3.0), 0.02);
}

TEST(RobustLoss, OfNormalErrorsIsAsWideAsAllowed) {
  const SolverOptions options;
  Random noise(1, "robust scale");
  std::vector<double> errors = rayleigh(0.1, 3000, &noise);
  const double clean = frameErrors(errors, options).value().width;
  // Median of a Rayleigh distribution: sigma sqrt(2 ln 2).
  EXPECT_NEAR(clean, options.robust_scale_medians * 0.1 * std::sqrt(2.0 * std::log(2.0)), 0.01);
  for (size_t i = 0; i < 600; ++i) errors[i] = 50.0;
  const double spoilt = frameErrors(errors, options).value().width;
  EXPECT_LT(spoilt, 0.8 * clean);
  EXPECT_GT(spoilt, 0.5 * clean);
}

TEST(RobustLoss, IsThatOfTheStatedNoiseAtMost) {
  Random noise(2, "robust scale");
  EXPECT_DOUBLE_EQ(frameErrors(rayleigh(3.0, 500, &noise), SolverOptions()).value().width,
                   SolverOptions().robust_scale_sigmas);
}

TEST(RobustLoss, IsNeverWiderThanAskedHoweverLittleThatIs) {
  SolverOptions narrow;
  narrow.robust_scale_sigmas = 0.01;
  EXPECT_DOUBLE_EQ(frameErrors(std::vector<double>(500, 1.0), narrow).value().width, 0.01);
}

TEST(RobustLoss, IsNeverNothing) {
  EXPECT_GT(frameErrors(std::vector<double>(500, 0.0), SolverOptions()).value().width, 0.0);
}

TEST(RobustLoss, StaysWhereFewErrorsTell) {
  EXPECT_FALSE(frameErrors({}, SolverOptions()).has_value());
  EXPECT_FALSE(frameErrors(std::vector<double>(10, 0.1), SolverOptions()).has_value());
}

// All tracks are accurate to a tenth of a pixel, but a third of them also slides to one side by 0.4 px/s. The
// edge of a shadow does so when its lamp moves with the rig. Returns the final position error, m.
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
    for (FeatureObservation& observation : frame->tracks.observations) {
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

TEST(RobustLoss, LetsShadowsDragTheRigLess) {
  SolverOptions as_stated;
  as_stated.robust_scale_medians = 1e3;
  as_stated.track_weights = false;
  double measured_m = 0.0, stated_m = 0.0;
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    measured_m += errorAmongShadows(SolverOptions(), seed);
    stated_m += errorAmongShadows(as_stated, seed);
  }
  EXPECT_LT(measured_m, 0.6 * stated_m);
}

TEST(RobustLoss, BelongsToAFrame) {
  TestWindow test;
  const SolverOptions options;
  const FrameId calm = test.add(Rigid3(), true).id, shaken = test.add(Rigid3(), true).id,
                unknown = test.add(Rigid3(), false).id;
  std::vector<ObservationError> errors;
  const auto add = [&](FrameId frame, int count, double sigmas) {
    for (TrackId track = 0; track < count; ++track) errors.push_back({track, frame, sigmas});
  };
  add(calm, 30, 0.1);
  add(shaken, 30, 0.4);
  add(unknown, 3, 0.1);
  adaptRobustLosses(test.window, errors, options);
  EXPECT_DOUBLE_EQ(test.factors.robustScale(*test.window.find(calm)), options.robust_scale_medians * 0.1);
  EXPECT_DOUBLE_EQ(test.factors.robustScale(*test.window.find(shaken)), options.robust_scale_medians * 0.4);
  EXPECT_DOUBLE_EQ(test.factors.robustScale(*test.window.find(unknown)), options.robust_scale_sigmas);
  resetRobustLosses(test.window);
  EXPECT_DOUBLE_EQ(test.factors.robustScale(*test.window.find(calm)), options.robust_scale_sigmas);
}

TEST(TrackWeight, IsOneWhereATrackIsLikeTheOthersOrNothingIsKnown) {
  EXPECT_DOUBLE_EQ(trackWeight({0.0, 0}, 1.0), 1.0);
  for (const int count : {1, 5, 30}) {
    EXPECT_DOUBLE_EQ(trackWeight({2.0 * count - 1.0, count}, 1.0), 1.0);
    EXPECT_DOUBLE_EQ(trackWeight({9.0 * count, count}, 0.0), 1.0);
  }
}

TEST(TrackWeight, GoesWithTheSquareOfTheInverseVarianceOfWhatIsOftenSeen) {
  EXPECT_NEAR(trackWeight({9.0 * 2000.0, 1000}, 1.0), 1.0 / 81.0, 1e-4);
  EXPECT_NEAR(trackWeight({0.8 * 2000.0, 1000}, 1.0), 1.0 / 0.64, 1e-2);
  EXPECT_NEAR(trackWeight({9.0 * 2000.0, 1000}, 0.5), 1.0 / 9.0, 1e-3);
  // One observation has little information, and the weight is limited.
  EXPECT_GT(trackWeight({9.0, 1}, 1.0), 2.0 / 81.0);
  EXPECT_DOUBLE_EQ(trackWeight({0.0, 1000}, 1.0), 2.0);
}

// Tracks of one to 16 observations; one in `every` has nine times the variance of the others.
double differenceWhereOneIn(int every, uint64_t seed) {
  Random noise(seed, "difference of tracks");
  ErrorsByTrack by_track;
  for (TrackId track = 0; track < 400; ++track) {
    TrackErrors& errors = by_track[track];
    errors.count = 1 + static_cast<int>(track % 16);
    const double sigma = track % every == 0 ? 3.0 : 1.0;
    for (int i = 0; i < 2 * errors.count; ++i) errors.sum_of_squares += std::pow(sigma * noise.normal(), 2);
  }
  return differenceOfTracks(by_track);
}

TEST(TrackWeight, TracksThatAreAllAlikeAreNoDifferenceAndOthersAre) {
  double alike = 0.0;
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    alike += 0.1 * differenceWhereOneIn(1000, seed);
    EXPECT_GT(differenceWhereOneIn(4, seed), 0.8) << seed;
  }
  EXPECT_LT(alike, 0.15);
  EXPECT_DOUBLE_EQ(differenceOfTracks({}), 0.0);
  EXPECT_DOUBLE_EQ(differenceOfTracks({{1, {100.0, 3}}, {2, {1.0, 3}}}), 0.0);
}

TEST(TrackWeight, TellsTracksThatSlideByErrorsWhichAloneAreUsual) {
  TestWindow test;
  constexpr TrackId kTracks = 80, kUnseen = 100;
  const auto slides = [](TrackId track) { return track % 5 == 0; };
  Random noise(3, "track weights");
  std::vector<ObservationError> errors;
  for (int i = 0; i < 8; ++i) {
    const FrameId frame = test.add(Rigid3(), true).id;
    for (TrackId track = 0; track < kTracks; ++track) {
      test.window.addObservation(track, {frame, 0, {}});
      const double usual = 0.1 * std::hypot(noise.normal(), noise.normal());
      // Twice the sigma of one axis: one in seven of the usual errors is that large.
      errors.push_back({track, frame, slides(track) ? 0.2 : usual});
    }
  }
  test.window.addObservation(kUnseen, {0, 0, {}});
  test.window.tracks().at(kUnseen).weight = 0.3;
  adaptRobustLosses(test.window, errors, SolverOptions());
  double sliding = 0.0, usual = 0.0;
  for (TrackId track = 0; track < kTracks; ++track)
    (slides(track) ? sliding : usual) += test.window.tracks().at(track).weight;
  EXPECT_LT(sliding / 16.0, 0.5 * usual / 64.0);
  EXPECT_DOUBLE_EQ(test.window.tracks().at(kUnseen).weight, 1.0);
  resetRobustLosses(test.window);
  EXPECT_DOUBLE_EQ(test.window.tracks().at(0).weight, 1.0);
}

TEST(TrackWeight, StaysOneWhereAFrameHasTooFewErrorsToTellTheUsualOnes) {
  TestWindow test;
  const FrameId frame = test.add(Rigid3(), true).id;
  std::vector<ObservationError> errors;
  for (TrackId track = 0; track < 5; ++track) {
    test.window.addObservation(track, {frame, 0, {}});
    errors.push_back({track, frame, 0.01});
  }
  adaptRobustLosses(test.window, errors, SolverOptions());
  for (const auto& [id, track] : test.window.tracks()) EXPECT_DOUBLE_EQ(track.weight, 1.0);
}

}  // namespace
}  // namespace lodeline
