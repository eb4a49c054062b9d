#include "simulation/rendering/cave/solid_texture.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lodeline {
namespace {

const SolidTexture& sharedTexture() {
  static const SolidTexture texture(3);
  return texture;
}

struct Spread {
  double mean = 0.0, sigma = 0.0;
};

Spread spreadAt(const SolidTexture& texture, float footprint_m) {
  double sum = 0.0, squares = 0.0;
  constexpr int kCount = 4000;
  for (int i = 0; i < kCount; ++i) {
    const Vec3f point(0.0173f * i, 0.0311f * i, 0.0057f * i);
    const double value = texture.sample(point, 0.5f, footprint_m).reflectance;
    sum += value;
    squares += value * value;
  }
  return {sum / kCount, std::sqrt(squares / kCount - sum * sum / kCount / kCount)};
}

TEST(SolidTexture, DetailFadesIntoTheMeanWithThePixelsWidth) {
  const SolidTexture& texture = sharedTexture();
  const Spread sharp = spreadAt(texture, 0.0f), wide = spreadAt(texture, 0.03f),
               all = spreadAt(texture, 1.0f);
  EXPECT_NEAR(sharp.mean, 0.0, 0.03);
  EXPECT_GT(sharp.sigma, 0.25);
  EXPECT_LT(wide.sigma, 0.5 * sharp.sigma);
  EXPECT_GT(wide.sigma, 0.02);
  EXPECT_EQ(all.sigma, 0.0);
}

TEST(SolidTexture, RepeatsSeamlessly) {
  const SolidTexture& texture = sharedTexture();
  for (int i = 0; i < 50; ++i) {
    const Vec3f point(0.011f * i, 0.5f - 0.007f * i, 0.003f * i);
    for (const float footprint : {0.0f, 0.006f, 0.02f}) {
      const TextureSample here = texture.sample(point, 0.5f, footprint);
      const TextureSample there = texture.sample(point + Vec3f(0.5f, -0.5f, 1.0f), 0.5f, footprint);
      EXPECT_NEAR(here.reflectance, there.reflectance, 2e-3f);
    }
  }
}

TEST(SolidTexture, IsContinuous) {
  const SolidTexture& texture = sharedTexture();
  float before = texture.sample(Vec3f::Zero(), 0.5f, 0.0f).reflectance;
  for (int i = 1; i < 5000; ++i) {
    const float now = texture.sample(Vec3f(0.0002f * i, 0.0001f * i, 0.0f), 0.5f, 0.0f).reflectance;
    EXPECT_LT(std::abs(now - before), 0.15f) << i;
    before = now;
  }
}

}  // namespace
}  // namespace lodeline
