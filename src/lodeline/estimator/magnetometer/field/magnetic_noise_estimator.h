#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "lodeline/ahrs/magnetometer_mean.h"
#include "lodeline/estimator/options/magnetometer_options.h"
#include "lodeline/estimator/uncertainty/time_correlated_error.h"
#include "lodeline/util/time/time.h"

namespace lodeline {

/// How far an undisturbed field is from the expected one for reasons that last, learned from its size and
/// dip, which show it without asking for a heading:
/// - a floor: rock, currents, what calibration leaves; its correlation falls to 1/e in
/// `correlated_noise_time_s`;
/// - a walk: iron on board that creeps, in body axes.
///
/// Means over a fifth of `correlated_noise_time_s` go to a bank of Kalman filters, each with a floor and a
/// walk of its own, whose state is the offset in body axes, the Earth's size and dip, and how far the floor
/// is off them now, a Gauss-Markov process. The likelihoods of the filters' innovations, older ones fading
/// with `correlated_noise_memory_s`, weigh the filters: multiple-model adaptive estimation (Magill, "Optimal
/// adaptive estimation of sampled stochastic processes", 1965). What is answered is the root of the weighted
/// mean of squares.
class MagneticNoiseEstimator {
 public:
  /// What is believed before the first reading: floor and walk are log-normal, by this factor wide, with the
  /// options' figures for root mean squares.
  static constexpr double kPriorFactor = 2.0;

  /// `offset_sigma_T`: of the offset before the first reading, per axis.
  MagneticNoiseEstimator(const MagnetometerOptions& options, double offset_sigma_T);

  /// A reading that was believed, of noise `white_variance_T2` per axis, and the window's orientation with
  /// its roll and pitch. The size of a field is not linear in an offset: it is linearized at `offset_B`, the
  /// window's.
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
    /// Offset in body axes, size, size times dip, the floor's part in these two; T
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
    double tilt_variance_rad2 = 0.0;  ///< as of independent means over the interval
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
