#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "lodeline/imu/noise/allan_deviation.h"

namespace lodeline {

/// The noises that an Allan variance is made of, in the order of their slope. With coefficient squared c^2
/// (two-sided densities, as in Kalibr):
///   Quantization  Q  [u s]             3 Q^2 / tau^2
///   White         N  [u/sqrt(Hz)]      N^2 / tau
///   Flicker       B  [u]               B^2 2 ln2 / pi      ("bias instability")
///   Walk          K  [u/s/sqrt(Hz)]    K^2 tau / 3
///   Ramp          R  [u/s]             R^2 tau^2 / 2       (a steady drift, not random)
/// (IEEE 952-1997, annex C.)
enum class NoiseKind { Quantization, White, Flicker, Walk, Ramp };
constexpr int kNoiseKinds = 5;
constexpr int kRandomKinds = 4;  ///< all but Ramp

/// Allan variance at `tau_s` of each noise with coefficient 1.
std::array<double, kNoiseKinds> unitAllanVariance(double tau_s);

/// Share of its flat Allan variance that flicker noise shows at `tau_s` when it holds nothing faster than
/// `corner_s`: a sum of first-order Gauss-Markov processes with all time constants above the corner. One for
/// a corner of zero.
double flickerShare(double tau_s, double corner_s);

/// How the estimates of the Allan variance at several averaging times scatter together, for Gaussian noise:
///   cov(AVAR_i, AVAR_j) = sum over kinds a, b of c_a^2 c_b^2 G_ab(i, j)
/// The estimates are means of squared second differences d of the integrated reading, hence
///   cov = 1 / (2 tau_i^2 tau_j^2) * mean over all pairs of moments of cov(d_i(t), d_j(t'))^2,
/// and each noise's cov(d_i, d_j) follows from the autocovariance of its integral. With i = j it is what
/// Greenhall & Riley ("Uncertainty of stability variances based on finite differences", PTTI 2003) turn into
/// degrees of freedom.
class AllanCovariance {
 public:
  /// For the given points of a curve, in ascending order of averaging time.
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
