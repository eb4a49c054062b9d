// Compares lamps, water and haze with closed forms and numeric integration.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "simulation/rendering/light/haze_volume.h"
#include "simulation/rendering/light/light_field.h"
#include "simulation/rendering/light/second_diver.h"

namespace lodeline {
namespace {

Lamp someLamp() {
  Lamp lamp;
  lamp.position_B = Vec3(0.1, 0.4, 0.2);
  lamp.direction_B = Vec3(1.0, -0.1, 0.0).normalized();
  lamp.spot_intensity = 3.0;
  lamp.flood_intensity = 5.0;
  return lamp;
}

TEST(FastExp, FollowsTheExponential) {
  for (float x = 0.0f; x > -60.0f; x -= 0.0137f) {
    EXPECT_NEAR(fastExp(x) / std::exp(x), 1.0, 3e-5) << x;
  }
  EXPECT_LT(fastExp(-1000.0f), 1e-30f);
  for (float x = 0.01f; x < 1000.0f; x *= 1.037f) EXPECT_NEAR(roughLog2(x), std::log2(x), 0.013) << x;
}

TEST(Lamp, HalvesAtItsHalfAnglesAndFallsWithTheSquare) {
  Lamp lamp = someLamp();
  lamp.flood_intensity = 0.0;
  const PlacedLamp spot(lamp, Rigid3());
  EXPECT_NEAR(spot.intensity(1.0f), 3.0, 1e-4);
  EXPECT_NEAR(spot.intensity(std::cos(static_cast<float>(lamp.spot_half_angle_rad))), 1.5, 1e-3);
  lamp.spot_intensity = 0.0;
  lamp.flood_intensity = 5.0;
  const PlacedLamp flood(lamp, Rigid3());
  EXPECT_NEAR(flood.intensity(std::cos(static_cast<float>(lamp.flood_half_angle_rad))), 2.5, 1e-3);
  const Vec3f towards = -lamp.direction_B.cast<float>();
  EXPECT_NEAR(flood.irradiance(towards, 1.0f) / flood.irradiance(towards, 3.0f), 9.0, 1e-3);
}

TEST(Water, PhaseFunctionIsNormalized) {
  WaterOptions options;
  options.asymmetry = 0.8;
  const Water water(options, 0.0, 1);
  double sum = 0.0, mean_cosine = 0.0;
  constexpr int kSteps = 20000;
  for (int i = 0; i < kSteps; ++i) {
    const double cosine = -1.0 + 2.0 * (i + 0.5) / kSteps;
    const double share =
        2.0 * std::numbers::pi * water.phase(static_cast<float>(cosine), 0.0f) * 2.0 / kSteps;
    sum += share;
    mean_cosine += share * cosine;
  }
  EXPECT_NEAR(sum, 1.0, 1e-3);
  EXPECT_NEAR(mean_cosine, 0.8, 1e-3);
}

TEST(Water, SiltComesAndGoes) {
  WaterOptions options;
  options.attenuation_per_m = 0.1;
  options.silt = {{10.0, 5.0, 2.0}};
  EXPECT_FLOAT_EQ(Water(options, 9.9, 1).mean().attenuation, 0.1f);
  EXPECT_NEAR(Water(options, 12.0, 1).mean().attenuation, 2.1f, 1e-4);
  EXPECT_FLOAT_EQ(Water(options, 15.1, 1).mean().attenuation, 0.1f);
}

TEST(HazeVolume, MatchesNumericIntegration) {
  WaterOptions options;
  options.attenuation_per_m = 0.3;
  LightField light{{PlacedLamp(someLamp(), Rigid3())}, {}, Water(options, 0.0, 1)};
  const Vec3f eye(0.0f, 0.0f, 0.0f);
  const Vec3f view = Vec3f(1.0f, 0.15f, -0.05f).normalized();
  const HazeVolume haze(light, eye, {view, view, view, view}, 2);
  for (const float range : {0.3f, 1.0f, 2.7f, 8.0f, 25.0f}) {
    double expected = 0.0;
    const int steps = 20000;
    for (int i = 0; i < steps; ++i) {
      const float r = range * (i + 0.5f) / steps;
      const Vec3f to_lamp = light.lamps[0].position() - (eye + r * view);
      const float d = std::sqrt(to_lamp.squaredNorm() + 0.03f * 0.03f);
      const double b = 0.3 * options.scattering_share, diffuse = 0.3 - options.asymmetry * b;
      expected += range / steps * b * std::exp(-diffuse * (r + d)) *
                  light.lamps[0].irradiance(to_lamp / d, d) *
                  light.water.phase(to_lamp.dot(view) / d, static_cast<float>(b));
    }
    const HazeSample sample = haze.at(7.0f, 3.0f, range);
    EXPECT_NEAR(sample.transmittance, std::exp(-0.3 * range), 2e-3) << range;
    // Steps have a width of a fifth of their distance, with linear interpolation between them.
    EXPECT_NEAR(sample.radiance, expected, 0.04 * expected) << range;
  }
}

TEST(SecondDiver, ComesAndGoesWithoutASwitch) {
  const SecondDiver diver;
  int present = 0, steps = 0;
  const auto brightnessAt = [&](double t) {
    const auto torch = placeSecondDiver(diver, Vec3::Zero(), Vec3::UnitX(), t, 7);
    return torch ? torch->intensity(1.0f) : 0.0f;
  };
  float before = brightnessAt(0.0);
  for (double t = 0.0; t < 600.0; t += 1.0 / 15.0, ++steps) {
    const float brightness = brightnessAt(t);
    EXPECT_LT(std::abs(brightness - before), 1.5f) << t;
    before = brightness;
    present += brightness > 0.0f;
  }
  EXPECT_GT(present, 0.2 * steps);
  EXPECT_LT(present, 0.9 * steps);
}

}  // namespace
}  // namespace lodeline
