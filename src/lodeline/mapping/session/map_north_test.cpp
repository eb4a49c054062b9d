#include "lodeline/mapping/session/map_north.h"

#include <gtest/gtest.h>

#include "lodeline/evaluation/trajectory/test_trajectories.h"
#include "lodeline/mapping/store/map_change.h"

namespace lodeline {
namespace {

TEST(MapNorth, EqualNorthsAreOne) {
  EXPECT_EQ(northSigma_rad(HeadingReference::True, HeadingReference::True), 0.0);
  EXPECT_EQ(northSigma_rad(HeadingReference::Magnetic, HeadingReference::Magnetic), 0.0);
}

TEST(MapNorth, TrueAndMagneticNorthDifferByADeclination) {
  const double sigma_rad = northSigma_rad(HeadingReference::True, HeadingReference::Magnetic);
  EXPECT_GT(sigma_rad, 0.2);
  EXPECT_LT(sigma_rad, 0.5);
  EXPECT_EQ(northSigma_rad(HeadingReference::Magnetic, HeadingReference::True), sigma_rad);
}

TEST(MapNorth, TheStartOfADiveSaysNothingOfNorth) {
  EXPECT_GT(northSigma_rad(HeadingReference::Start, HeadingReference::True), M_PI);
  EXPECT_GT(northSigma_rad(HeadingReference::Start, HeadingReference::Magnetic), M_PI);
}

TEST(MapNorth, AMapHasTheBestNorthOfItsDives) {
  const test::TemporaryFolder folder;
  MapFile map = MapFile::create(folder.path() / "cave.db", {});
  EXPECT_EQ(northOf(map), HeadingReference::Start);
  for (const HeadingReference north :
       {HeadingReference::Start, HeadingReference::Magnetic, HeadingReference::True,
        HeadingReference::Magnetic, HeadingReference::Start}) {
    MapChange change = map.change();
    MapDive dive;
    dive.name = std::to_string(map.dives().size());
    dive.heading_reference = north;
    change.addDive(dive);
    change.commit();
    const bool has_true = map.dives().size() > 2;
    EXPECT_EQ(northOf(map), has_true ? HeadingReference::True : north);
  }
}

}  // namespace
}  // namespace lodeline
