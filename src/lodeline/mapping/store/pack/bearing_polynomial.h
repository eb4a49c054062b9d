#pragma once

#include <optional>
#include <vector>

#include "lodeline/mapping/store/pack/packed_bytes.h"
#include "lodeline/types.h"

namespace lodeline {

/// A vector as a polynomial of a bearing: pixels and origins of the rays of one camera, which its lens and
/// port make smooth functions of the direction.
///
/// The arguments are x = theta cos(phi), y = theta sin(phi), rad. theta is the angle between the bearing b
/// and the axis a, phi the azimuth of b around a. The monomials are 1, x, y, x^2, x y, y^2, x^3, ... up to
/// the degree; the coefficients are float32.
class BearingPolynomial {
 public:
  static constexpr int kMostDegree = 7;

  /// Fits a polynomial to `values` (dimension x count). Nothing where there are fewer than two values for
  /// each coefficient, or where one value differs by more than `tolerance`.
  static std::optional<BearingPolynomial> fit(const std::vector<Vec3>& bearings,
                                              const Eigen::MatrixXd& values, int degree, double tolerance);
  /// A function with the same value for all bearings.
  static BearingPolynomial constant(const Eigen::VectorXd& value);

  Eigen::VectorXd operator()(const Vec3& bearing) const;
  const Vec3& axis() const { return axis_; }

  void write(ByteWriter* writer) const;
  static BearingPolynomial read(ByteReader* reader, int dimension);

 private:
  int degree_ = 0;
  Vec3 axis_ = Vec3::UnitZ();
  Eigen::MatrixXd coefficients_;  ///< dimension x monomial
};

}  // namespace lodeline
