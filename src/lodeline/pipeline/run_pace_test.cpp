#include "lodeline/pipeline/run_pace.h"

#include <gtest/gtest.h>

namespace lodeline {
namespace {

using Clock = std::chrono::steady_clock;

Time at(double t_s) { return Time::fromNanoseconds(1700000000000000000) + Duration::fromSeconds(t_s); }

double seconds(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

TEST(RunPace, ReadsNoFasterThanTheRate) {
  RunPace pace(4.0, [] { return false; });
  const auto start = Clock::now();
  for (int i = 0; i <= 8; ++i) pace.await(at(0.1 * i));
  EXPECT_GE(seconds(start), 0.2);
}

TEST(RunPace, WithoutARateWaitsForNothing) {
  RunPace pace(std::nullopt, [] { return false; });
  const auto start = Clock::now();
  for (int i = 0; i < 100; ++i) pace.await(at(10.0 * i));
  EXPECT_LT(seconds(start), 5.0);
}

TEST(RunPace, AStopEndsTheWaiting) {
  int asked = 0;
  RunPace pace(1.0, [&asked] { return ++asked > 3; });
  const auto start = Clock::now();
  pace.await(at(0.0));
  pace.await(at(1000.0));
  EXPECT_LT(seconds(start), 100.0);
}

TEST(RunPace, WaitsForAReadyBrowser) {
  int asked = 0;
  waitUntil([&asked] { return ++asked == 5; }, [] { return false; });
  EXPECT_EQ(asked, 5);
}

}  // namespace
}  // namespace lodeline
