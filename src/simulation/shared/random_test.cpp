#include "simulation/shared/random.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lodeline {
namespace {

TEST(Random, IsReproducibleAndSeparatesStreamsAndSeeds) {
  Random a(7, "imu");
  Random b(7, "imu");
  Random other_stream(7, "mag");
  Random other_seed(8, "imu");
  const uint64_t first = a.next();
  EXPECT_EQ(first, b.next());
  EXPECT_NE(first, other_stream.next());
  EXPECT_NE(first, other_seed.next());
}

TEST(Random, NormalHasTheMomentsOfTheStandardNormal) {
  constexpr int kCount = 200000;
  Random random(1, "test");
  double sum = 0.0, square = 0.0, fourth = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const double x = random.normal();
    sum += x;
    square += x * x;
    fourth += x * x * x * x;
  }
  // Five standard errors each.
  EXPECT_NEAR(sum / kCount, 0.0, 5.0 / std::sqrt(kCount));
  EXPECT_NEAR(square / kCount, 1.0, 5.0 * std::sqrt(2.0 / kCount));
  EXPECT_NEAR(fourth / kCount, 3.0, 5.0 * std::sqrt(96.0 / kCount));
}

TEST(Random, UniformStaysInItsRangeWithTheRightMean) {
  Random random(2, "test");
  double sum = 0.0;
  for (int i = 0; i < 100000; ++i) {
    const double x = random.uniform(-1.0, 3.0);
    ASSERT_GE(x, -1.0);
    ASSERT_LT(x, 3.0);
    sum += x;
  }
  EXPECT_NEAR(sum / 100000, 1.0, 0.02);
}

}  // namespace
}  // namespace lodeline
