#include "lodeline/estimator/dvl/dvl_trust.h"

#include <gtest/gtest.h>

namespace lodeline {
namespace {

/// A record with pings at 5 Hz.
struct TrustRecord {
  DvlTrust trust = DvlTrust(10.0);
  int pings = 0;

  void add(int count, bool agrees, bool is_test) {
    for (int i = 0; i < count; ++i) trust.add(Time::fromSeconds(0.2 * ++pings), agrees, is_test);
  }
};

TEST(DvlTrust, ComesWithTestsAlone) {
  TrustRecord record;
  record.add(40, true, false);
  EXPECT_FALSE(record.trust.isTrusted()) << "nothing has been tested";
  record.add(1, true, true);
  EXPECT_FALSE(record.trust.isTrusted());
  record.add(1, true, true);
  EXPECT_TRUE(record.trust.isTrusted());
  EXPECT_EQ(record.trust.waited_s(), 0.0);
}

TEST(DvlTrust, SurvivesSingleFaultsAndEndsWithMany) {
  TrustRecord record;
  record.add(2, true, true);
  for (int i = 0; i < 20; ++i) {
    record.add(3, false, true);
    EXPECT_TRUE(record.trust.isTrusted());
    record.add(3, true, true);
  }
  record.add(4, false, true);
  EXPECT_FALSE(record.trust.isTrusted());
}

TEST(DvlTrust, DoesNotComeBackByChance) {
  TrustRecord record;
  for (int i = 0; i < 100; ++i) {
    record.add(3, false, true);
    record.add(1, true, true);
    record.add(20, true, false);
    EXPECT_FALSE(record.trust.isTrusted());
  }
  EXPECT_TRUE(record.trust.isOverdue());
  record.add(8, true, true);
  EXPECT_TRUE(record.trust.isTrusted());
  EXPECT_FALSE(record.trust.isOverdue());
}

TEST(DvlTrust, OfASensorThatNothingTestsComesAfterTheWait) {
  TrustRecord record;
  record.add(51, true, false);
  EXPECT_FALSE(record.trust.isTrusted());
  record.add(1, true, false);
  EXPECT_TRUE(record.trust.isTrusted());
  TrustRecord faulty;
  faulty.add(1, false, true);
  faulty.add(60, true, false);
  EXPECT_FALSE(faulty.trust.isTrusted()) << "it has disagreed";
  EXPECT_TRUE(faulty.trust.isOverdue());
}

}  // namespace
}  // namespace lodeline
