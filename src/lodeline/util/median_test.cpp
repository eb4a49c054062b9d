#include "lodeline/util/median.h"

#include <gtest/gtest.h>

#include "lodeline/rig.h"

namespace lodeline {
namespace {

TEST(Median, IsTheUpperOneOfAnEvenNumber) {
  EXPECT_EQ(median(std::vector<int>{5, 1, 3}), 3);
  EXPECT_EQ(median(std::vector<int>{5, 1, 3, 4}), 4);
}

TEST(Median, OfNothingIsZero) { EXPECT_EQ(median(std::vector<double>()), 0.0); }

TEST(OrderStatistic, RunsFromTheSmallestToTheLargest) {
  const std::vector<double> values = {9.0, 7.0, 8.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0, 0.0};
  EXPECT_EQ(orderStatistic(values, 0.0), 0.0);
  EXPECT_EQ(orderStatistic(values, 0.9), 9.0);
  EXPECT_EQ(orderStatistic(values, 1.0), 9.0);
}

TEST(MedianStep, IgnoresAGap) {
  std::vector<DepthSample> samples(5);
  for (size_t i = 0; i < samples.size(); ++i)
    samples[i].time = Time::fromSeconds(0.1 * static_cast<double>(i) + (i > 2 ? 60.0 : 0.0));
  EXPECT_NEAR(medianStep_s(samples), 0.1, 1e-9);
  samples.resize(1);
  EXPECT_EQ(medianStep_s(samples), 0.0);
}

}  // namespace
}  // namespace lodeline
