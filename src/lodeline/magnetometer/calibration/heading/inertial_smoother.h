#pragma once

#include <span>
#include <vector>

#include "lodeline/magnetometer/calibration/heading/bordered_chain.h"
#include "lodeline/magnetometer/calibration/heading/inertial_calibration.h"

namespace lodeline {

/// Noise that the likelihood is evaluated at.
struct SmootherNoise {
  double reading_sigma = 0.01;      ///< of one reading, units of the field's size
  double gyroscope_density = 1e-4;  ///< rad/s/sqrt(Hz)
  double acceleration_sigma = 1.0;  ///< m/s^2, of moments that are independent of each other
};

/// The orientations at the moments of a record and everything that ties them to each other and to the
/// parameters, linearized at one point.
class InertialSmoother {
 public:
  using Chain = BorderedChain<inertial_parameter::kSize>;

  /// Readings in a moment share one orientation.
  struct Moment {
    Time stamp;                   ///< mean of the readings' stamps
    Vec3 reading = Vec3::Zero();  ///< mean
    std::vector<Time> stamps;
    bool used = true;  ///< whether the field counts
  };

  InertialSmoother(std::span<const NormalizedFieldSample> field, std::span<const ImuSample> imu,
                   const InertialParameters& start, const InertialCalibrationOptions& options);

  const std::vector<Moment>& moments() const { return moments_; }
  const InertialParameters& parameters() const { return parameters_; }

  /// Takes all residuals and Jacobians anew at the present orientations and parameters.
  void linearize();
  /// The normal equations, half the sum of squares in them.
  Chain equations(const SmootherNoise& noise) const;
  /// Sum of the logarithms of the standard deviations of everything in equations().
  double logSigmas(const SmootherNoise& noise) const;
  /// Moves parameters and orientations.
  void step(const Eigen::Matrix<double, inertial_parameter::kSize, 1>& parameters,
            const std::vector<Vec3>& rotations);

  /// Field residuals at the last linearization, per moment.
  Vec3 fieldResidualAt(size_t moment) const { return terms_[moment].field.value; }
  size_t readingsAt(size_t moment) const { return moments_[moment].stamps.size(); }
  /// RMS per axis of the specific force's distance from gravity, m/s^2.
  double accelerationRms() const;
  void setUsed(size_t moment, bool used) { moments_[moment].used = used; }

 private:
  struct Terms {
    InertialResidual field, gravity;
    TurnResidual turn;    ///< to the next moment
    double step_s = 0.0;  ///< to the next moment
    double gap_s = 0.0;   ///< of it without gyroscope
  };

  void makeMoments(std::span<const NormalizedFieldSample> field, const GyroscopePath& path);
  void orient(const GyroscopePath& path);
  double turnSigma(const Terms& terms, const SmootherNoise& noise) const;

  std::span<const ImuSample> imu_;
  InertialCalibrationOptions options_;
  InertialParameters parameters_;
  std::vector<Moment> moments_;
  std::vector<Quat> world_from_body_;
  std::vector<Terms> terms_;
};

}  // namespace lodeline
