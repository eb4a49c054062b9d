#include "lodeline/util/choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <vector>

#include "lodeline/diagnostics.h"

namespace lodeline {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::vector<std::string> kNames = {"survex", "therion", "kml"};

TEST(Choice, CaseDoesNotMatter) {
  EXPECT_EQ(chooseByName("--format", "Survex", kNames), 0u);
  EXPECT_EQ(chooseByName("--format", "KML", kNames), 2u);
}

TEST(Choice, TheNearestNameIsSuggested) {
  try {
    chooseByName("--format", "survx", kNames);
    FAIL() << "nothing was thrown";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("one of survex, therion, kml"));
    EXPECT_THAT(error.what(), HasSubstr("did you mean 'survex'?"));
  }
}

TEST(Choice, NothingIsSuggestedWhereNothingIsNear) {
  EXPECT_EQ(nearestName("xyzzy", kNames), "");
  try {
    chooseByName("--format", "xyzzy", kNames);
    FAIL() << "nothing was thrown";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), Not(HasSubstr("did you mean")));
  }
}

}  // namespace
}  // namespace lodeline
