#pragma once

#include <span>
#include <vector>

#include "lodeline/magnetometer/iron/magnetometer_fit.h"

namespace lodeline {

/// Parameters of the ellipsoid of raw readings, whose corrected readings are on the unit sphere:
/// |A (y - h)| = 1, with A in units of 1 / reading.
struct IronParameters {
  Mat3 correction = Mat3::Identity();  ///< A
  Vec3 hard_iron = Vec3::Zero();       ///< h
};

/// Signed distance of a reading from the surface, to first order, in the unit of the readings (Sampson's
/// distance):
///   r = (|A (y - h)| - 1) / |A^T u|,  u = A (y - h) / |A (y - h)|
/// For white noise of sigma in each axis of y, r has that sigma. The derivative is by A (xx yy zz xy xz yz)
/// and h, with the denominator held constant; the fit iterates with it.
struct IronResidual {
  double distance = 0.0;
  Eigen::Matrix<double, 1, 9> jacobian;
};
IronResidual ironResidual(const Vec3& reading, const IronParameters& parameters);

struct IronFitOptions {
  IronModel model = IronModel::Full;
  /// Readings beyond this number of robust standard deviations are excluded from the fit.
  double rejection_sigmas = 4.0;
  int max_iterations = 50;
  /// Prior uncertainty of the soft-iron entries that a model does not estimate: one relative sigma of the
  /// difference to `start`, for diagonal and off-diagonal entries of A. It increases the covariance of the
  /// estimated and the other parameters (Schmidt's "consider" parameters).
  double left_out_scale_sigma = 0.03;
  double left_out_skew_sigma = 0.02;
};

/// Basis (9 rows: A's entries and h; one column per direction) of the parameter changes that a model allows
/// at A.
Eigen::Matrix<double, 9, Eigen::Dynamic> activeDirections(IronModel model, const Mat3& correction);

/// Covariance P of parameters p with information matrix H. The columns of `active` were estimated, and
/// the other directions were held fixed with the covariance `left_out` (Schmidt's consider covariance):
///   K = active (active^T H active)^-1 active^T,  P = K + (I - K H) left_out (I - K H)^T
Eigen::MatrixXd consideredCovariance(const Eigen::MatrixXd& information, const Eigen::MatrixXd& active,
                                     const Eigen::MatrixXd& left_out);

struct IronFit {
  IronParameters parameters;
  /// Covariance of A and h from the scatter of the residuals. It is increased for the correlation of
  /// residuals in time and for the parameters that the model does not estimate.
  Eigen::Matrix<double, 9, 9> covariance = Eigen::Matrix<double, 9, 9>::Zero();
  /// Ratio of the largest to the smallest eigenvalue of the model's normal equations, with columns scaled to
  /// unit length. Infinite where they are singular.
  double condition_number = 0.0;
  std::vector<bool> used;  ///< per reading; false for outliers
  double sigma = 0.0;      ///< standard deviation of a residual, unit of the readings
  double correlation_factor = 1.0;
};

/// Robust least squares from `start`: damped Gauss-Newton over the parameters of the model, with outlier
/// rejection by the median absolute deviation. Parameters outside the model keep the values of `start`.
/// Readings must be in order of time. Throws EstimationError where it does not converge to a positive
/// definite A.
IronFit fitIron(std::span<const Vec3> readings, const IronParameters& start, const IronFitOptions& options);

/// Ratio of the variance of a correlated series' sum to that of independent values of the same variance: 1 +
/// 2 times the sum of autocorrelations up to the first that is not positive.
double correlationFactor(std::span<const double> series);

/// Median of absolute values times 1.4826: a robust estimate of the standard deviation of normal values.
double robustSigma(std::vector<double> values);

}  // namespace lodeline
