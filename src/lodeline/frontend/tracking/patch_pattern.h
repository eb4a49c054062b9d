#pragma once

#include <array>

namespace lodeline {

/// Sampling pattern of a patch, px from its centre: a disc on a grid of odd offsets. It is symmetric, so that
/// constant, u and v are orthogonal on it.
struct PatchPattern {
  static constexpr int kSide = 8;
  static constexpr float kSpacing = 2.0F;
  static constexpr float kMaxRadius2 = 60.0F;

  static constexpr float offset(int index) {
    return (static_cast<float>(index) - 0.5F * (kSide - 1)) * kSpacing;
  }
  static constexpr bool inside(int column, int row) {
    return offset(column) * offset(column) + offset(row) * offset(row) < kMaxRadius2;
  }
  static constexpr int count() {
    int n = 0;
    for (int i = 0; i < kSide * kSide; ++i) n += inside(i % kSide, i / kSide) ? 1 : 0;
    return n;
  }
  /// Largest offset along one axis.
  static constexpr float kReach = 0.5F * (kSide - 1) * kSpacing;

  static constexpr auto offsets(bool vertical) {
    std::array<float, static_cast<size_t>(count())> result{};
    size_t n = 0;
    for (int i = 0; i < kSide * kSide; ++i) {
      if (inside(i % kSide, i / kSide)) result[n++] = offset(vertical ? i / kSide : i % kSide);
    }
    return result;
  }
};

inline constexpr int kPatchSize = PatchPattern::count();
inline constexpr auto kPatchU = PatchPattern::offsets(false);
inline constexpr auto kPatchV = PatchPattern::offsets(true);
/// One value per sample of the pattern.
using PatchValues = std::array<float, static_cast<size_t>(kPatchSize)>;

static_assert(kPatchSize % 4 == 0, "loops over the pattern are vectorised without remainder");

}  // namespace lodeline
