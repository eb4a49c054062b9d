#include "lodeline/imu/noise/sensor_noise.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lodeline/diagnostics.h"
#include "lodeline/imu/test_noise.h"

namespace lodeline {
namespace {

using ::testing::HasSubstr;

constexpr double kRate_hz = 100.0;
constexpr double kWhite = 1e-4;  // rad/s/sqrt(Hz)

Time at(int64_t i) { return Time::fromNanoseconds(1700000000000000000 + i * 10000000); }

class SensorNoiseTest : public ::testing::Test {
 protected:
  /// Twenty minutes of a gyroscope at rest, modified by `change`. Readings for which it returns false are
  /// left out.
  template <typename Change>
  SensorNoise analyse(Change change, int readings = 120000) {
    SensorNoiseAnalysis analysis(gyroscopeToAnalyse(), &diagnostics_);
    TestNoise noise(kWhite, 0.0, 0.0, kRate_hz, 3);
    for (int i = 0; i < readings; ++i) {
      Vec3 reading = Vec3(0.01, -0.02, 0.005) + noise.next();
      Time time = at(i);
      if (change(i, &time, &reading)) analysis.add(time, reading);
    }
    return analysis.finish();
  }

  template <typename Change>
  void expectRefused(Change change, const char* why, int readings = 60000) {
    try {
      analyse(change, readings);
      ADD_FAILURE() << "accepted; expected: " << why;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr(why));
    }
  }

  static bool asItIs(int, Time*, Vec3*) { return true; }

  Diagnostics diagnostics_;
};

TEST_F(SensorNoiseTest, OfAGoodRecordIsRightAndSaysWhatItCannotKnow) {
  const SensorNoise noise = analyse(asItIs);
  EXPECT_NEAR(noise.all.white.value, kWhite, 0.01 * kWhite);
  EXPECT_NEAR(noise.rate_hz, kRate_hz, 1e-6);
  EXPECT_EQ(noise.repeated, 0);
  EXPECT_EQ(noise.stillness.moved, 0);
  EXPECT_EQ(diagnostics_.count("gyroscope_short_for_white_noise"), 0);
  EXPECT_EQ(diagnostics_.count("gyroscope_short_for_instability"), 1);
  EXPECT_EQ(diagnostics_.count("gyroscope_short_for_walk"), 1);
}

TEST_F(SensorNoiseTest, PassesOverReadingsThatAreNone) {
  const SensorNoise noise = analyse([](int i, Time* time, Vec3* reading) {
    if (i % 1000 == 500) reading->y() = std::nan("");
    if (i % 1000 == 700) *time = at(i - 3);
    return true;
  });
  EXPECT_EQ(diagnostics_.count("gyroscope_not_finite"), 120);
  EXPECT_EQ(diagnostics_.count("gyroscope_disorder"), 120);
  EXPECT_NEAR(noise.all.white.value, kWhite, 0.01 * kWhite);
}

TEST_F(SensorNoiseTest, PassesOverSpikes) {
  const SensorNoise noise = analyse([](int i, Time*, Vec3* reading) {
    if (i % 10000 == 500) reading->y() = 1e6;
    return true;
  });
  EXPECT_EQ(diagnostics_.count("gyroscope_spike"), 12);
  EXPECT_NEAR(noise.all.white.value, kWhite, 0.01 * kWhite);
}

TEST_F(SensorNoiseTest, BridgesShortGapsAndSplitsAtLongOnes) {
  // A drift that would become a step if both sides were joined.
  const SensorNoise noise = analyse([](int i, Time*, Vec3* reading) {
    reading->x() += i < 60000 ? 0.0 : 2.0 * kWhite;
    const bool short_gap = i % 5000 > 4980;
    const bool long_gap = i > 50000 && i < 60000;
    return !short_gap && !long_gap;
  });
  EXPECT_GT(diagnostics_.count("gyroscope_gap"), 15);
  EXPECT_NEAR(noise.duration_s, 1100.0, 1.0);
  EXPECT_NEAR(noise.rate_hz, kRate_hz, 0.01);
  EXPECT_NEAR(noise.all.white.value, kWhite, 0.02 * kWhite);
  EXPECT_EQ(noise.all.walk.resolved, false);
}

TEST_F(SensorNoiseTest, TakesReadingsThatComeInBurstsAsEvenlySpaced) {
  const SensorNoise noise = analyse([](int i, Time* time, Vec3*) {
    // Bursts of ten readings, stamped on arrival.
    *time = at(i / 10 * 10 + 9) + Duration::fromNanoseconds(i % 10 * 100000);
    return true;
  });
  EXPECT_EQ(diagnostics_.count("gyroscope_gap"), 0);
  EXPECT_NEAR(noise.rate_hz, kRate_hz, 0.1);
  EXPECT_NEAR(noise.all.white.value, kWhite, 0.01 * kWhite);
}

TEST_F(SensorNoiseTest, LeavesOutReadingsThatAreOnlyHeld) {
  Vec3 held = Vec3::Zero();
  const SensorNoise noise = analyse([&](int i, Time*, Vec3* reading) {
    if (i % 4 == 0) held = *reading;
    *reading = held;
    return true;
  });
  EXPECT_EQ(diagnostics_.count("gyroscope_repeated"), 1);
  EXPECT_EQ(noise.repeated, 90000);
  EXPECT_NEAR(noise.rate_hz, 25.0, 0.01);
  // The scatter of the readings is unchanged, but only one in four is a new reading.
  EXPECT_NEAR(noise.all.white.value, 2.0 * kWhite, 0.02 * 2.0 * kWhite);
}

TEST_F(SensorNoiseTest, KeepsReadingsThatCoarseResolutionRepeats) {
  // A resolution of two sigma: each axis repeats often, and sometimes all three at once.
  const double step = 2.0 * kWhite * std::sqrt(kRate_hz);
  const SensorNoise noise = analyse([&](int, Time*, Vec3* reading) {
    *reading = (*reading / step).array().round().matrix() * step;
    return true;
  });
  EXPECT_EQ(noise.repeated, 0);
  EXPECT_EQ(diagnostics_.count("gyroscope_repeated"), 0);
  // Rounding adds a variance of a twelfth of its step squared.
  EXPECT_NEAR(noise.all.white.value, kWhite * std::sqrt(1.0 + 4.0 / 12.0), 0.05 * kWhite);
}

TEST_F(SensorNoiseTest, SaysWhenTheSensorWasMoved) {
  const SensorNoise noise = analyse([](int i, Time*, Vec3* reading) {
    if (i > 40000 && i < 42000) reading->z() += 0.2 * std::sin(0.05 * i);
    return true;
  });
  EXPECT_EQ(diagnostics_.count("gyroscope_moved"), 1);
  EXPECT_GE(noise.stillness.moved, 2);
  EXPECT_LE(noise.stillness.moved, 4);
  ASSERT_TRUE(noise.stillness.first_moved);
  EXPECT_NEAR((*noise.stillness.first_moved - at(40000)).seconds(), 0.0, 10.0);
}

TEST_F(SensorNoiseTest, SaysWhenTheSensorIsFiltered) {
  Vec3 filtered = Vec3::Zero();
  analyse([&](int i, Time*, Vec3* reading) {
    filtered = i == 0 ? *reading : Vec3(filtered + 0.1 * (*reading - filtered));
    *reading = filtered;
    return true;
  });
  EXPECT_EQ(diagnostics_.count("gyroscope_filtered"), 1);
}

TEST_F(SensorNoiseTest, SaysWhenItDrifts) {
  analyse([](int i, Time*, Vec3* reading) {
    *reading += Vec3::Constant(5e-9 * i);
    return true;
  });
  EXPECT_EQ(diagnostics_.count("gyroscope_drift"), 1);
}

TEST_F(SensorNoiseTest, NamesAnAxisThatIsNotRead) {
  const SensorNoise noise = analyse([](int, Time*, Vec3* reading) {
    reading->y() = 0.0;
    return true;
  });
  EXPECT_EQ(diagnostics_.count("gyroscope_axis_silent"), 1);
  EXPECT_NEAR(noise.axes[0].white.value, kWhite, 0.02 * kWhite);
}

TEST_F(SensorNoiseTest, RefusesWhatSaysNothing) {
  expectRefused([](int, Time*, Vec3*) { return false; }, "0 usable readings");
  expectRefused([](int i, Time*, Vec3*) { return i == 0; }, "1 usable readings");
  expectRefused(asItIs, "100 usable readings", 100);
  expectRefused(
      [](int, Time* time, Vec3*) {
        *time = Time();
        return true;
      },
      "all have the stamp 0 ns");
  expectRefused(
      [](int i, Time* time, Vec3*) {
        *time = Time::fromSeconds(1000.0 - 0.01 * i);
        return true;
      },
      "stored in reverse order");
  expectRefused(
      [](int i, Time* time, Vec3*) {
        *time = Time::fromSeconds(0.01 * (i % 20));
        return true;
      },
      "have no later time than one before them");
  expectRefused(
      [](int, Time*, Vec3* reading) {
        *reading = Vec3(0.01, 0.02, 0.03);
        return true;
      },
      "frozen");
  expectRefused(
      [](int i, Time*, Vec3* reading) {
        *reading += 0.5 * std::sin(0.01 * i) * Vec3::Ones();
        return true;
      },
      "not still");
  expectRefused(
      [](int, Time*, Vec3* reading) {
        reading->x() = std::nan("");
        return true;
      },
      "0 usable readings");
}

}  // namespace
}  // namespace lodeline
