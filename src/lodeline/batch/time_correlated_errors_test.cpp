#include "lodeline/batch/time_correlated_errors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace lodeline {
namespace {

/// Removes the part of the errors that the landmark absorbs: the mean and, along its parallax (x), the trend.
void takeLandmark(std::vector<Vec2>* errors) {
  const auto n = static_cast<double>(errors->size());
  const auto fromMiddle = [&](size_t i) { return static_cast<double>(i) - 0.5 * (n - 1.0); };
  Vec2 mean = Vec2::Zero();
  for (const Vec2& error : *errors) mean += error / n;
  double slope = 0.0;
  for (size_t i = 0; i < errors->size(); ++i) slope += fromMiddle(i) * (*errors)[i].x();
  slope /= n * (n * n - 1.0) / 12.0;
  for (size_t i = 0; i < errors->size(); ++i) (*errors)[i] -= mean + Vec2(slope * fromMiddle(i), 0.0);
}

/// Statistics of tracks of `length` observations with white noise and a random walk, in these shares of the
/// final variance.
TimeCorrelatedErrors errorsOf(int length, double walk_share) {
  constexpr int kTracks = 2000;
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  TimeCorrelatedErrors lasting;
  for (int track = 0; track < kTracks; ++track) {
    std::vector<Vec2> errors;
    Vec2 walk = Vec2::Zero();
    for (int i = 0; i < length; ++i) {
      walk += std::sqrt(walk_share / length) * Vec2(normal(random), normal(random));
      errors.push_back(walk + std::sqrt(1.0 - walk_share) * Vec2(normal(random), normal(random)));
    }
    takeLandmark(&errors);
    lasting.add(errors);
  }
  return lasting;
}

TEST(TimeCorrelatedErrors, OfWhiteNoiseEveryObservationCounts) {
  for (const int length : {6, 10, 20, 40}) EXPECT_EQ(errorsOf(length, 0.0).designEffect(), 1.0) << length;
}

TEST(TimeCorrelatedErrors, OfARandomWalkATrackCountsAsOne) {
  for (const int length : {6, 10, 20, 40})
    EXPECT_NEAR(errorsOf(length, 1.0).designEffect(), length, 0.06 * length) << length;
}

TEST(TimeCorrelatedErrors, OfBothItLiesBetween) {
  double last = 1.0;
  for (const double walk_share : {0.8, 0.95, 0.99, 1.0}) {
    const double effect = errorsOf(12, walk_share).designEffect();
    EXPECT_GT(effect, last + 0.5) << walk_share;
    last = effect;
  }
}

// Residuals of a tenth of the stated error, as after a solution of images: their correlation is within the
// stated variance.
TEST(TimeCorrelatedErrors, AddToTheVarianceWhatIsNotStated) {
  constexpr int kLength = 20;
  TimeCorrelatedErrors small, large;
  for (int track = 0; track < 50; ++track) {
    std::vector<Vec2> errors;
    for (int i = 0; i < kLength; ++i) errors.push_back(Vec2(i < kLength / 2 ? 1.0 : -1.0, 0.0));
    for (Vec2& error : errors) error *= 0.1;
    small.add(errors);
    for (Vec2& error : errors) error *= 10.0;
    large.add(errors);
  }
  EXPECT_EQ(small.designEffect(), large.designEffect());
  EXPECT_EQ(small.variance(), 1.0);
  EXPECT_NEAR(large.variance(), 0.5 * large.designEffect(), 1e-9);
  EXPECT_GT(large.variance(), 5.0);
  EXPECT_NEAR(errorsOf(kLength, 0.0).variance(), 1.0, 0.1);
}

TEST(TimeCorrelatedErrors, AreUnknownWhileThereIsNothingToTellThemBy) {
  TimeCorrelatedErrors lasting;
  EXPECT_EQ(lasting.designEffect(), 1.0);
  lasting.add({});
  lasting.add({Vec2(1.0, 2.0), Vec2(1.0, 2.0), Vec2(1.0, 2.0)});  // too short
  lasting.add(std::vector<Vec2>(10, Vec2::Zero()));               // exact
  EXPECT_EQ(lasting.designEffect(), 1.0);
}

}  // namespace
}  // namespace lodeline
