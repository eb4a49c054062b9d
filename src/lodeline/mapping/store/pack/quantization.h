#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "lodeline/types.h"

/// Values of features in few bits. The steps are small against the uncertainty of what is measured.
namespace lodeline {

/// Unit vectors on the octahedron |x| + |y| + |z| = 1, unfolded to a square of so many steps along each edge
/// (Z. Cigolle et al., "A survey of efficient representations for independent unit vectors", JCGT 2014). The
/// largest error is 4.3 / steps rad, the root mean square a third of it.
class DirectionGrid {
 public:
  explicit DirectionGrid(uint16_t steps) : steps_(steps) {}
  /// Fine enough for rays of that standard deviation: errors are less than a quarter of it, or 7e-5 rad.
  static DirectionGrid forSigma(double sigma_rad);

  uint16_t steps() const { return steps_; }
  std::array<uint16_t, 2> pack(const Vec3& direction) const;
  Vec3 unpack(uint16_t u, uint16_t v) const;

 private:
  uint16_t steps_;
};

/// Distances 1 mm exp(step code).
class DistanceScale {
 public:
  explicit DistanceScale(double step) : step_(static_cast<float>(step)) {}
  /// Fine enough for distances of that relative standard deviation: errors are less than an eighth of it, or
  /// 0.05 %, and never more than 1 %.
  static DistanceScale forSigma(double relative_sigma);

  double step() const { return step_; }
  std::optional<uint16_t> pack(double distance_m) const;  ///< nothing outside the range
  double unpack_m(uint16_t code) const;

 private:
  double step_;
};

/// Standard deviation `least` exp(0.1 code), so to 5 %; clamped to that range.
uint8_t packSigma(double sigma, double least);
double unpackSigma(uint8_t code, double least);
constexpr double kLeastRaySigma_rad = 1e-6;
constexpr double kLeastDistanceSigma_m = 1e-4;

/// A direction relative to a predicted one: along the two vectors of tangentBasis(predicted), each in 15
/// steps of half a sigma. Nothing beyond 3.75 sigmas.
std::optional<uint8_t> packResidual(const Vec3& direction, const Vec3& predicted, double sigma_rad);
Vec3 unpackResidual(uint8_t code, const Vec3& predicted, double sigma_rad);
constexpr uint8_t kNoResidual = 0xff;  ///< no code of packResidual

}  // namespace lodeline
