#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "lodeline/ahrs/magnetometer_mean.h"
#include "lodeline/estimator/uncertainty/time_correlated_error.h"
#include "lodeline/problem/options/magnetometer_options.h"
#include "lodeline/types.h"

namespace lodeline {

/// Estimates the time-correlated errors of an undisturbed field from its size and dip, which do not depend on
/// the heading:
/// - a floor: rock, currents, residual calibration errors; its correlation falls to 1/e within
///   `correlated_noise_time_s`;
/// - a walk: magnetization of iron on board that changes slowly, in body axes.
///
/// A bank of Kalman filters processes means over a fifth of `correlated_noise_time_s`. Each filter has its
/// own floor and walk. Its state contains the offset in body axes, and the size and dip of the Earth's field.
/// Further states are the floor's present deviations from both, Gauss-Markov processes. The likelihoods of
/// the filters' innovations weight the filters; older likelihoods fade with `correlated_noise_memory_s`. This
/// is multiple-model adaptive estimation (Magill, "Optimal adaptive estimation of sampled stochastic
/// processes", 1965). The result is the root of the weighted mean of squares.
class MagneticNoiseEstimator {
 public:
  /// Width of the prior: floor and walk are log-normal with this factor, and the options' values are their
  /// root mean squares.
  static constexpr double kPriorFactor = 2.0;

  /// `offset_sigma_T`: sigma of the offset before the first reading, per axis.
  MagneticNoiseEstimator(const MagnetometerOptions& options, double offset_sigma_T);

  /// Adds an accepted reading with white noise of `white_variance_T2` per axis. `world_from_body` and `tilt`:
  /// the window's orientation and the error of its roll and pitch. The size of the field is not linear in the
  /// offset; it is linearized at `offset_B`, the window's estimate.
  void add(const MagnetometerMean& mean, const Quat& world_from_body, const Vec3& offset_B,
           double white_variance_T2, const TimeCorrelatedError& tilt);

  double correlated_noise_sigma_T() const { return correlated_noise_sigma_T_; }
  double walk_T_per_sqrt_s() const { return walk_T_per_sqrt_s_; }

 private:
  static constexpr int kStates = 7;
  using State = Eigen::Matrix<double, kStates, 1>;
  using Derivative = Eigen::Matrix<double, 2, kStates>;
  struct Model {
    double correlated_noise_sigma_T = 0.0, walk_T_per_sqrt_s = 0.0;
    double log_prior = 0.0, log_likelihood = 0.0;
    /// Offset in body axes, size of the field, size times dip, deviations of both by the floor; T
    State state = State::Zero();
    Eigen::Matrix<double, kStates, kStates> covariance = Eigen::Matrix<double, kStates, kStates>::Zero();
  };
  /// Sums over readings.
  struct Sums {
    Time begin;
    int readings = 0;
    Vec2 measured_T = Vec2::Zero();
    Derivative derivative = Derivative::Zero();
    double white_variance_T2 = 0.0;
    double tilt_variance_rad2 = 0.0;  ///< for means that count as independent over the interval
  };

  void learn(Time now);
  double interval_s() const { return 0.2 * options_.correlated_noise_time_s; }
  void predict(double since_s, Model* model) const;
  void update(const Sums& sums, Model* model) const;
  void weigh();

  MagnetometerOptions options_;
  std::vector<Model> models_;
  double correlated_noise_sigma_T_ = 0.0, walk_T_per_sqrt_s_ = 0.0;
  double size_T_ = 0.0;  ///< of the first field
  std::optional<Sums> sums_;
  std::optional<Time> updated_;
};

}  // namespace lodeline
