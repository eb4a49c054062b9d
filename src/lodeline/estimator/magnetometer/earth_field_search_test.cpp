#include "lodeline/estimator/magnetometer/earth_field_search.h"

#include <gtest/gtest.h>

namespace lodeline {
namespace {

const Vec3 kEarth_W(0.0, 24e-6, -38e-6);
const Vec3 kBoat_W(14e-6, 20e-6, -38e-6);

// Feeds a field for some seconds at 5 Hz; gives the time of a replacement of the Earth's field.
class Search {
 public:
  std::optional<double> feed(const Vec3& field_W, double duration_s, bool is_plausible = true) {
    std::optional<double> taken_s;
    for (const double end_s = time_s_ + duration_s; time_s_ < end_s; time_s_ += 0.2) {
      EarthFieldSearch::Reading reading;
      reading.time = Time::fromSeconds(1000.0 + time_s_);
      reading.field_W = field_W;
      reading.agrees = (field_W - in_force_W_).norm() < 1e-6;
      reading.is_plausible = is_plausible;
      reading.is_field_in_force_plausible = is_force_plausible;
      if (const std::optional<Vec3> taken_W = search_.add(reading)) {
        taken_s = time_s_;
        in_force_W_ = *taken_W;
        is_force_plausible = true;
      }
    }
    return taken_s;
  }
  void pause(double seconds) { time_s_ += seconds; }

  bool is_force_plausible = true;

 private:
  EarthFieldSearch search_;
  Vec3 in_force_W_ = kBoat_W;
  double time_s_ = 0.0;
};

TEST(EarthFieldSearch, TakesTheFieldThatHoldsForLonger) {
  Search search;
  EXPECT_FALSE(search.feed(kBoat_W, 40.0));
  const std::optional<double> taken_s = search.feed(kEarth_W, 60.0);
  ASSERT_TRUE(taken_s);
  EXPECT_NEAR(*taken_s, 80.0, 1.0);
  EXPECT_FALSE(search.feed(kBoat_W, 30.0)) << "what holds for a shorter time is a disturbance";
}

TEST(EarthFieldSearch, WaitsBeforeItReplacesAFieldOfAMoment) {
  Search search;
  search.feed(kBoat_W, 1.0);
  const std::optional<double> taken_s = search.feed(kEarth_W, 60.0);
  ASSERT_TRUE(taken_s);
  EXPECT_NEAR(*taken_s, 1.0 + EarthFieldSearch::kLeast_s, 1.0);
}

TEST(EarthFieldSearch, KeepsAFieldThatHasLongBeenConfirmed) {
  Search search;
  search.feed(kBoat_W, EarthFieldSearch::kConfirmed_s + 5.0);
  EXPECT_FALSE(search.feed(kEarth_W, 1000.0));
}

TEST(EarthFieldSearch, KeepsTheFieldWhileNoOtherHolds) {
  Search search;
  search.feed(kBoat_W, 5.0);
  for (int i = 0; i < 40; ++i) EXPECT_FALSE(search.feed(i % 2 == 0 ? kEarth_W : Vec3(1.1 * kEarth_W), 4.0));
}

TEST(EarthFieldSearch, GivesUpOnACalibrationThatIsWrong) {
  Search search;
  int taken = 0;
  for (int i = 0; i < 40; ++i) taken += search.feed(i % 2 == 0 ? kEarth_W : kBoat_W, 400.0).has_value();
  EXPECT_LE(taken, EarthFieldSearch::kMostReplacements);
}

TEST(EarthFieldSearch, DoesNotCountAPause) {
  Search search;
  search.feed(kBoat_W, 10.0);
  search.feed(kEarth_W, 5.0);
  search.pause(100.0);
  EXPECT_FALSE(search.feed(kEarth_W, 5.0));
}

TEST(EarthFieldSearch, KnowsTheFieldOfTheSite) {
  Search search;
  search.is_force_plausible = false;
  EXPECT_FALSE(search.feed(kBoat_W, 100.0, false));
  const std::optional<double> taken_s = search.feed(kEarth_W, 10.0);
  ASSERT_TRUE(taken_s);
  EXPECT_NEAR(*taken_s, 100.0 + EarthFieldSearch::kPlausible_s, 1.0);
}

}  // namespace
}  // namespace lodeline
