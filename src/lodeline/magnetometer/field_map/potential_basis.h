#pragma once

#include <Eigen/Core>
#include <vector>

#include "lodeline/types.h"

namespace lodeline {

/// A scalar potential phi in a box, as a sum of m basis functions with random weights. Its gradient is a
/// magnetic field without sources in the box: B = grad phi is free of curl by construction.
///
/// The basis functions are the eigenfunctions of the Laplace operator in the box |x_d| <= L that vanish on
/// its faces:
///   phi_j(x) = prod_d L^(-1/2) sin(pi n_jd (x_d + L) / (2 L)),   eigenvalue lambda_j = sum_d (pi n_jd / 2
///   L)^2.
/// Independent weights w_j ~ N(0, S(sqrt(lambda_j))) approximate a Gaussian process with the squared
/// exponential covariance of length scale l and standard deviation s. Its spectral density is
///   S(omega) = s^2 (2 pi l^2)^(3/2) exp(-omega^2 l^2 / 2).
/// All functions with lambda_j <= (kCutOff / l)^2 are used. A component of the field then has the standard
/// deviation s / l. Method: A. Solin, M. Kok, N. Wahlstroem, T. B. Schoen and S. Saerkkae, "Modeling and
/// Interpolation of the Ambient Magnetic Field by Gaussian Processes", IEEE Transactions on Robotics 34,
/// 2018.
class PotentialBasis {
 public:
  /// Greatest angular frequency, in units of 1 / l. It contains 89 % of the field's variance.
  static constexpr double kCutOff = 3.0;

  using Gradients = Eigen::Matrix<double, 3, Eigen::Dynamic>;

  /// `half_size_m`: L; `length_scale_m`: l; `field_sigma_T`: of each component of the field. Throws
  /// UsageError where one of them is not positive or the box is smaller than the length scale.
  PotentialBasis(double half_size_m, double length_scale_m, double field_sigma_T);

  int size() const { return static_cast<int>(indices_.size()); }
  double halfSize_m() const { return half_size_m_; }
  /// Variances of the weights, (T m)^2 m^3.
  const Eigen::VectorXd& weightVariances() const { return weight_variances_; }

  /// Derivative of the field with respect to the weights at a point in the box (m from its centre): 3 x m.
  Gradients gradients(const Vec3& point) const;
  /// Derivative of the field of `weights` with respect to the point, T/m: the symmetric matrix of second
  /// derivatives of the potential.
  Mat3 fieldByPoint(const Vec3& point, const Eigen::VectorXd& weights) const;

 private:
  /// Along one axis: the functions, and their first and second derivatives, for n = 1, 2, ...
  struct Axis {
    Eigen::ArrayXd value, first, second;
  };
  Axis along(double coordinate_m) const;

  double half_size_m_;
  int greatest_index_ = 0;
  std::vector<Eigen::Vector3i> indices_;
  Eigen::VectorXd weight_variances_;
};

}  // namespace lodeline
