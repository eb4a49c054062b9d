#include "lodeline/imu/noise/allan_deviation.h"

#include <gtest/gtest.h>

#include "lodeline/imu/test_noise.h"

namespace lodeline {
namespace {

constexpr double kInterval_s = 0.01;

/// Allan variance by definition, from averages over neighbouring stretches of `factor` readings, starting at
/// every reading.
double overlappingVariance(const std::vector<Vec3>& readings, size_t factor, int axis) {
  double sum = 0.0;
  size_t count = 0;
  for (size_t begin = 0; begin + 2 * factor <= readings.size(); ++begin) {
    double first = 0.0, second = 0.0;
    for (size_t i = 0; i < factor; ++i) {
      first += readings[begin + i][axis];
      second += readings[begin + factor + i][axis];
    }
    sum += std::pow((second - first) / static_cast<double>(factor), 2);
    ++count;
  }
  return 0.5 * sum / static_cast<double>(count);
}

const AllanPoint& at(const AllanCurve& curve, int64_t factor) {
  for (const AllanPoint& point : curve.points) {
    if (point.factor == factor) return point;
  }
  throw std::runtime_error("no such averaging time");
}

TEST(AllanDeviation, IsTheMeanSquareOfDifferencesOfNeighbouringAverages) {
  TestNoise noise(1e-3, 1e-3, 1e-3, 1.0 / kInterval_s, 1);
  std::vector<Vec3> readings;
  AllanAccumulator accumulator;
  for (int i = 0; i < 3000; ++i) {
    readings.push_back(Vec3(0.0, 9.8, -3.0) + noise.next());
    accumulator.add(readings.back());
  }
  const AllanCurve curve = accumulator.curve(kInterval_s);
  for (const int factor : {1, 2, 7, 16, 28}) {
    for (int axis = 0; axis < 3; ++axis) {
      const double expected = overlappingVariance(readings, static_cast<size_t>(factor), axis);
      EXPECT_NEAR(at(curve, factor).variance[axis], expected, 1e-9 * expected) << factor;
    }
    EXPECT_DOUBLE_EQ(at(curve, factor).tau_s, factor * kInterval_s);
    EXPECT_EQ(at(curve, factor).terms, 3000 - 2 * factor + 1);
  }
  // Longer differences start only at every second, fourth, … reading.
  for (const int factor : {32, 56, 64, 96, 224, 256}) {
    const double expected = overlappingVariance(readings, static_cast<size_t>(factor), 1);
    EXPECT_NEAR(at(curve, factor).variance[1], expected, 0.05 * expected) << factor;
  }
}

TEST(AllanDeviation, GivesFourTimesAnOctaveUpToHalfTheRecord) {
  AllanAccumulator accumulator;
  for (int i = 0; i < 1024; ++i) accumulator.add(Vec3(i % 2, 0.0, 0.0));
  const AllanCurve curve = accumulator.curve(kInterval_s);
  EXPECT_EQ(curve.points.back().factor, 512);
  EXPECT_DOUBLE_EQ(curve.duration_s, 10.24);
  for (size_t i = 12; i < curve.points.size(); ++i) {
    EXPECT_LT(curve.points[i].tau_s / curve.points[i - 1].tau_s, 1.26);
  }
}

TEST(AllanDeviation, OfASteadyDriftGrowsWithTheAveragingTime) {
  AllanAccumulator accumulator;
  for (int i = 0; i < 100000; ++i)
    accumulator.add(Vec3(1e-3, -2e-3, 0.0) * (i * kInterval_s) + Vec3(5, 5, 5));
  for (const AllanPoint& point : accumulator.curve(kInterval_s).points) {
    EXPECT_NEAR(point.variance.x(), 0.5 * std::pow(1e-3 * point.tau_s, 2), 1e-6 * point.variance.x() + 1e-22);
    EXPECT_NEAR(point.variance.y(), 4.0 * point.variance.x(), 1e-5 * point.variance.y() + 1e-22);
    EXPECT_NEAR(point.variance.z(), 0.0, 1e-22);
  }
}

TEST(AllanDeviation, LooksAtNoDifferenceAcrossABreak) {
  AllanAccumulator accumulator;
  for (int stretch = 0; stretch < 4; ++stretch) {
    accumulator.breakOff();
    // Constant within a stretch, so that any mixture of two stretches would be visible.
    for (int i = 0; i < 500; ++i) accumulator.add(Vec3::Constant(100.0 * stretch));
  }
  const AllanCurve curve = accumulator.curve(kInterval_s);
  EXPECT_EQ(curve.points.back().factor, 224);
  EXPECT_EQ(at(curve, 1).terms, 4 * 499);
  for (const AllanPoint& point : curve.points) EXPECT_NEAR(point.variance.norm(), 0.0, 1e-12);
}

TEST(AllanDeviation, OfNothingIsEmpty) {
  AllanAccumulator accumulator;
  EXPECT_TRUE(accumulator.curve(kInterval_s).points.empty());
  accumulator.add(Vec3::Ones());
  EXPECT_TRUE(accumulator.curve(kInterval_s).points.empty());
}

}  // namespace
}  // namespace lodeline
