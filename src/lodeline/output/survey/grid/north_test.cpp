#include "lodeline/output/survey/grid/north.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/util/angles.h"

namespace lodeline {
namespace {

using ::testing::HasSubstr;

const GeodeticPosition kPlace = {29.83, -82.60, 0.0};

TEST(North, AppliesTheDeclinationToMagneticNorthOnly) {
  // Devil's Eye on that day: -6.38 degrees by WMM2025.
  const North magnetic = findNorth(HeadingReference::Magnetic, kPlace, "2026-11-21", std::nullopt);
  EXPECT_NEAR(magnetic.turn_rad / kDegree, -6.38, 0.01);
  EXPECT_TRUE(magnetic.is_true);
  EXPECT_THAT(magnetic.text, HasSubstr("declination -6.38 deg"));
  const North north = findNorth(HeadingReference::True, kPlace, "2026-11-21", std::nullopt);
  EXPECT_EQ(north.turn_rad, 0.0);
  EXPECT_TRUE(north.is_true);
}

TEST(North, IsWhatTheUserSays) {
  for (HeadingReference reference :
       {HeadingReference::True, HeadingReference::Magnetic, HeadingReference::Start}) {
    EXPECT_NEAR(findNorth(reference, kPlace, "", 12.5).turn_rad, 12.5 * kDegree, 1e-12);
  }
}

TEST(North, StaysAsItIsWithoutAPlace) {
  EXPECT_FALSE(findNorth(HeadingReference::Magnetic, std::nullopt, "", std::nullopt).is_true);
  EXPECT_FALSE(findNorth(HeadingReference::Start, std::nullopt, "", std::nullopt).is_true);
}

TEST(North, RefusesAPlaceWithoutANorth) {
  EXPECT_THROW(findNorth(HeadingReference::Start, kPlace, "2026-11-21", std::nullopt), UsageError);
  EXPECT_THROW(findNorth(HeadingReference::Magnetic, kPlace, "", std::nullopt), UsageError);
  EXPECT_THROW(findNorth(HeadingReference::Magnetic, kPlace, "1894-06-24", std::nullopt), InputError);
}

}  // namespace
}  // namespace lodeline
