#include "lodeline/util/settings/option_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

TEST(OptionCheck, AcceptsValuesWithinTheirRanges) {
  EXPECT_NO_THROW(OptionCheck("window")
                      .positive("a", 1e-300)
                      .notNegative("b", 0.0)
                      .atLeast("c", 3, 3.0)
                      .within("d", 1.0, 0.0, 1.0));
}

TEST(OptionCheck, RefusesOthersByName) {
  const OptionCheck check("window");
  EXPECT_THROW(check.positive("a", 0.0), UsageError);
  EXPECT_THROW(check.notNegative("a", -1e-9), UsageError);
  EXPECT_THROW(check.atLeast("a", 2, 3.0), UsageError);
  EXPECT_THROW(check.within("a", 1.1, 0.0, 1.0), UsageError);
  EXPECT_THROW(check.within("a", -0.1, 0.0, 1.0), UsageError);
  EXPECT_THAT([&] { check.atLeast("keyframes", 2, 3.0); },
              testing::ThrowsMessage<UsageError>("window.keyframes must be at least 3, not 2"));
}

TEST(OptionCheck, RefusesWhatIsNoNumber) {
  const OptionCheck check("window");
  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(check.positive("a", value), UsageError);
    EXPECT_THROW(check.notNegative("a", value), UsageError);
    EXPECT_THROW(check.atLeast("a", value, 0.0), UsageError);
    EXPECT_THROW(check.within("a", value, 0.0, 1.0), UsageError);
  }
}

}  // namespace
}  // namespace lodeline
