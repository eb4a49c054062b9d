#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "lodeline/base/time.h"
#include "lodeline/estimator/magnetometer_options.h"
#include "lodeline/inertial/magnetometer_mean.h"

namespace lodeline {

/// How far an undisturbed field is from the expected one for reasons that last, learned from its size and
/// dip, which show it without asking for a heading:
/// - a floor: rock, currents, what calibration leaves; the same for `floor_correlation_s`, then another;
/// - a walk: iron on board that creeps, in body axes.
///
/// Means over `floor_correlation_s` go to a bank of Kalman filters, each with a floor and a walk of its own,
/// whose state is the offset in body axes and the Earth's size and dip. The likelihoods of their
/// innovations, older ones fading with `floor_memory_s`, weigh the filters: multiple-model adaptive
/// estimation (Magill, "Optimal adaptive estimation of sampled stochastic processes", 1965). What is
/// answered is the root of the weighted mean of squares.
class FieldErrors {
 public:
  /// `offset_sigma_T`: of the offset before the first reading, per axis.
  FieldErrors(const MagnetometerOptions& options, double offset_sigma_T);

  /// A reading that was believed, of noise `white_variance_T2` per axis, and the window's orientation, with
  /// roll and pitch known to `tilt_variance_rad2` per axis. The size of a field is not linear in an offset:
  /// it is linearised at `offset_B`, the window's.
  void add(const MagnetometerMean& mean, const Quat& world_from_body, const Vec3& offset_B,
           double white_variance_T2, double tilt_variance_rad2);

  double floor_T() const { return floor_T_; }
  double walk_T_per_sqrt_s() const { return walk_T_per_sqrt_s_; }

 private:
  using Vec5 = Eigen::Matrix<double, 5, 1>;
  using Mat5 = Eigen::Matrix<double, 5, 5>;
  using Mat25 = Eigen::Matrix<double, 2, 5>;
  struct Model {
    double floor_T = 0.0, walk_T_per_sqrt_s = 0.0;
    double log_prior = 0.0, log_likelihood = 0.0;
    Vec5 state = Vec5::Zero();  ///< offset in body axes, size, size times dip; T
    Mat5 covariance = Mat5::Zero();
  };
  /// Sums over readings.
  struct Sums {
    Time begin;
    int readings = 0;
    Vec2 measured_T = Vec2::Zero();
    Mat25 derivative = Mat25::Zero();
    double white_variance_T2 = 0.0, tilt_variance_rad2 = 0.0;
  };

  void learn(Time now);
  void update(const Sums& sums, double since_s, Model* model) const;
  void weigh();

  MagnetometerOptions options_;
  std::vector<Model> models_;
  double floor_T_ = 0.0, walk_T_per_sqrt_s_ = 0.0;
  double size_T_ = 0.0;  ///< of the first field
  std::optional<Sums> sums_;
  std::optional<Time> updated_;
};

}  // namespace lodeline
