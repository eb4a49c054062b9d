#pragma once

#include <span>
#include <vector>

#include "lodeline/magnetometer/calibration/heading/bordered_chain.h"
#include "lodeline/magnetometer/calibration/heading/inertial_calibration.h"

namespace lodeline {

/// Noise parameters of the likelihood.
struct SmootherNoise {
  double reading_sigma = 0.01;      ///< of one reading, units of the field magnitude
  double gyroscope_density = 1e-4;  ///< rad/s/sqrt(Hz)
  double acceleration_sigma = 1.0;  ///< m/s^2, for independent moments
};

/// Orientations at the moments of a record, with all residuals between them and the parameters, linearized at
/// one point.
class InertialSmoother {
 public:
  using Chain = BorderedChain<inertial_parameter::kSize>;

  /// A group of readings that share one orientation.
  struct Moment {
    Time stamp;                   ///< mean of the stamps of the readings
    Vec3 reading = Vec3::Zero();  ///< mean
    std::vector<Time> stamps;
    bool used = true;  ///< whether the field residual is used
  };

  InertialSmoother(std::span<const NormalizedFieldSample> field, std::span<const ImuSample> imu,
                   const InertialParameters& start, const InertialCalibrationOptions& options);

  const std::vector<Moment>& moments() const { return moments_; }
  const InertialParameters& parameters() const { return parameters_; }

  /// Computes all residuals and Jacobians at the current orientations and parameters.
  void linearize();
  /// The normal equations with half the sum of squares.
  Chain equations(const SmootherNoise& noise) const;
  /// Sum of the logarithms of the standard deviations of all residuals in equations().
  double logSigmas(const SmootherNoise& noise) const;
  /// Updates parameters and orientations.
  void step(const Eigen::Matrix<double, inertial_parameter::kSize, 1>& parameters,
            const std::vector<Vec3>& rotations);

  /// Field residual of a moment at the last linearization.
  Vec3 fieldResidualAt(size_t moment) const { return terms_[moment].field.value; }
  size_t readingsAt(size_t moment) const { return moments_[moment].stamps.size(); }
  /// RMS per axis of the difference between specific force and gravity, m/s^2.
  double accelerationRms() const;
  void setUsed(size_t moment, bool used) { moments_[moment].used = used; }

 private:
  struct Terms {
    InertialResidual field, gravity;
    TurnResidual turn;    ///< to the next moment
    double step_s = 0.0;  ///< to the next moment
    double gap_s = 0.0;   ///< part of the step without gyroscope readings
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
