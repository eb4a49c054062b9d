#pragma once

#include <optional>
#include <vector>

#include "lodeline/mapping/keyframe/map_keyframe.h"
#include "lodeline/mapping/store/pack/bearing_polynomial.h"

namespace lodeline {

/// Pixels and origins of all rays of one camera in a keyframe, as functions of the bearing. Where a
/// polynomial does not fit well enough, the values themselves are kept.
class RayFunctions {
 public:
  static constexpr double kPixelTolerance_px = 4.0;  ///< for pictures and for the share of the image covered
  /// 0.2 mm shift a point at 1 m by 0.2 mrad, a fifth of a ray's usual sigma.
  static constexpr double kOriginTolerance_m = 2e-4;

  RayFunctions() = default;
  /// `rays`: of one camera, in the order of the features.
  explicit RayFunctions(const std::vector<const BodyRay*>& rays);

  /// Of the ray with that number.
  Vec2 pixel(size_t number, const Vec3& bearing_B) const;
  Vec3 origin_B(size_t number, const Vec3& bearing_B) const;
  /// Bearing of a point from the origin of the ray.
  Vec3 predictedBearing(size_t number, const Vec3& point_B) const;

  void write(ByteWriter* writer) const;
  static RayFunctions read(ByteReader* reader, size_t count);

 private:
  std::optional<BearingPolynomial> pixel_, origin_;
  Eigen::MatrixXd pixels_, origins_;  ///< 2 x count and 3 x count, where there is no polynomial
};

}  // namespace lodeline
