#include "lodeline/frontend/tracking/patch_sampling.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lodeline {
namespace {

/// Texture of the given contrast on a steep brightness gradient.
PatchValues texture(float contrast, float phase) {
  PatchValues values;
  for (size_t i = 0; i < values.size(); ++i) {
    values[i] = 140.0F + 9.0F * kPatchU[i] - 6.0F * kPatchV[i] +
                contrast * std::sin(0.7F * static_cast<float>(i * i) + phase);
  }
  return values;
}

TEST(PatchSampling, ProductsWithNormalizedValuesNeedNoNormalizing) {
  PatchValues pattern = texture(30.0F, 0.4F);
  normalize(pattern);
  std::array<PatchValues, 2> rows{texture(20.0F, 1.9F), texture(25.0F, 3.1F)};
  for (PatchValues& row : rows) detrend(row);
  const PatchValues values = texture(3.0F, 1.0F);
  const auto along = normalizedAlong<3>(values, {&pattern, &rows[0], &rows[1]});
  PatchValues normalized = values;
  normalize(normalized);
  EXPECT_GT(std::abs(dot(normalized, pattern)), 0.1F);
  EXPECT_NEAR(along[0], dot(normalized, pattern), 1e-3F);
  for (size_t i = 0; i < rows.size(); ++i)
    EXPECT_NEAR(along[1 + i], dot(normalized, rows[i]), 1e-3F * std::sqrt(dot(rows[i], rows[i])));
}

TEST(PatchSampling, WhatHasNoContrastLiesAlongNothing) {
  PatchValues flat, pattern = texture(30.0F, 0.4F);
  normalize(pattern);
  flat.fill(77.0F);
  EXPECT_EQ(normalizedAlong<1>(flat, {&pattern})[0], 0.0F);
}

}  // namespace
}  // namespace lodeline
