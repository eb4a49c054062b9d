#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "lodeline/imu/noise/allan_deviation.h"

namespace lodeline {

/// Noise processes of an Allan variance in the order of their slopes. With coefficient squared c^2 (two-sided
/// densities, as in Kalibr):
///   Quantization  Q  [u s]             3 Q^2 / tau^2
///   White         N  [u/sqrt(Hz)]      N^2 / tau
///   Flicker       B  [u]               B^2 2 ln2 / pi      ("bias instability")
///   Walk          K  [u/s/sqrt(Hz)]    K^2 tau / 3
///   Ramp          R  [u/s]             R^2 tau^2 / 2       (a constant drift, not random)
/// (IEEE 952-1997, annex C.)
enum class NoiseKind { Quantization, White, Flicker, Walk, Ramp };
constexpr int kNoiseKinds = 5;
constexpr int kRandomKinds = 4;  ///< all but Ramp

/// Allan variance at `tau_s` of each noise process with coefficient 1.
std::array<double, kNoiseKinds> unitAllanVariance(double tau_s);

/// Ratio of the Allan variance at `tau_s` of band-limited flicker noise to the constant one of ideal flicker
/// noise. The band-limited noise is a sum of first-order Gauss-Markov processes with all time constants above
/// `corner_s`. One for a corner of zero.
double flickerShare(double tau_s, double corner_s);

/// Covariance of the estimated Allan variances at several averaging times, for Gaussian noise:
///   cov(AVAR_i, AVAR_j) = sum over kinds a, b of c_a^2 c_b^2 G_ab(i, j)
/// The estimates are means of squared second differences d of the integrated reading. Hence
///   cov = 1 / (2 tau_i^2 tau_j^2) * mean over all pairs of moments of cov(d_i(t), d_j(t'))^2,
/// The cov(d_i, d_j) of each noise follows from the autocovariance of its integral. For i = j, Greenhall
/// & Riley ("Uncertainty of stability variances based on finite differences", PTTI 2003) convert it to
/// degrees of freedom.
class AllanCovariance {
 public:
  /// For the points of a curve in ascending order of averaging time.
  AllanCovariance(const std::vector<AllanPoint>& points, double interval_s, double duration_s);

  /// `squared`: c^2 of Quantization, White, Flicker, Walk.
  Eigen::MatrixXd operator()(const std::array<double, kRandomKinds>& squared) const;

 private:
  void fill(int row, int column, const AllanPoint& shorter, const AllanPoint& longer, double interval_s,
            double duration_s);

  /// G_ab for a <= b.
  std::array<std::array<Eigen::MatrixXd, kRandomKinds>, kRandomKinds> pairs_;
};

}  // namespace lodeline
