#pragma once

#include <span>
#include <vector>

#include "lodeline/magnetometer/iron/magnetometer_fit.h"

namespace lodeline {

/// Parameters of the sphere that corrected readings lie on: |A (y - h)| = 1, with A in units of
/// 1 / reading.
struct IronParameters {
  Mat3 correction = Mat3::Identity();  ///< A
  Vec3 hard_iron = Vec3::Zero();       ///< h
};

/// How far a reading lies from the sphere, to first order in the unit of the readings:
///   r = (|A (y - h)| - 1) / |A^T u|,  u = A (y - h) / |A (y - h)|
/// (Sampson's distance: for white noise of sigma in each axis of y, r has that sigma). The derivative is by
/// A (xx yy zz xy xz yz) and h, with the denominator held; it is what the fit iterates on.
struct IronResidual {
  double distance = 0.0;
  Eigen::Matrix<double, 1, 9> jacobian;
};
IronResidual ironResidual(const Vec3& reading, const IronParameters& parameters);

struct IronFitOptions {
  IronModel model = IronModel::Full;
  /// Readings further off than so many robust standard deviations are left out of the fit.
  double rejection_sigmas = 4.0;
  int max_iterations = 50;
  /// How far a sensor's soft iron may lie from `start` where the model leaves it out, one sigma of a diagonal
  /// and of another entry of A, relative. It widens the covariance, of the left out and of the estimated
  /// parameters alike (Schmidt's "consider" parameters).
  double left_out_scale_sigma = 0.03;
  double left_out_skew_sigma = 0.02;
};

/// The directions (columns, 9 rows: A's entries and h) in which a model lets the parameters move at A.
Eigen::Matrix<double, 9, Eigen::Dynamic> activeDirections(IronModel model, const Mat3& correction);

/// Covariance of parameters p with information matrix H, of which `active` (columns) were estimated and the
/// others held although they have the covariance `left_out`:
///   K = active (active^T H active)^-1 active^T,  P = K + (I - K H) left_out (I - K H)^T
Eigen::MatrixXd consideredCovariance(const Eigen::MatrixXd& information, const Eigen::MatrixXd& active,
                                     const Eigen::MatrixXd& left_out);

struct IronFit {
  IronParameters parameters;
  /// Of A and h, from the scatter of the residuals, widened for their correlation in time and for what the
  /// model leaves out.
  Eigen::Matrix<double, 9, 9> covariance = Eigen::Matrix<double, 9, 9>::Zero();
  /// Of the model's normal equations with columns scaled to unit length: largest by smallest eigenvalue.
  /// Infinite where they are singular.
  double condition_number = 0.0;
  std::vector<bool> used;  ///< of the readings, false for outliers
  double sigma = 0.0;      ///< of a residual, unit of the readings
  double correlation_factor = 1.0;
};

/// Robust least squares from `start`: Gauss-Newton with damping over the parameters of the model, outliers
/// told by the median absolute deviation. What the model leaves out keeps the value of `start`. Readings in
/// order of time. Throws EstimationError where it does not converge to a positive definite A.
IronFit fitIron(std::span<const Vec3> readings, const IronParameters& start, const IronFitOptions& options);

/// By how much a series' sum scatters more (in variance) than that of independent values of the same
/// variance: 1 + 2 times the sum of autocorrelations up to the first that is not positive.
double correlationFactor(std::span<const double> series);

/// Median of absolute values times 1.4826: the standard deviation of normal values, outliers or not.
double robustSigma(std::vector<double> values);

}  // namespace lodeline
