#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "lodeline/imu/propagation.h"
#include "lodeline/problem/options/options.h"
#include "lodeline/types.h"

namespace lodeline {

/// Relative sigma of one camera's scale that small errors of the intrinsics cause without any trace in the
/// residuals. Part of the flow from the rig's rotations, which correlate with its accelerations, then counts
/// as translation. Simulated dives with calibrations off by 0.3 % behind a flat port came out 0 to 2 % too
/// small.
constexpr double kOneCameraScaleSigma = 0.01;

/// With such intrinsics the estimate of a translation v is v + C v. A rotation w adds a translation d D w,
/// where d is the distance of the observed scene. The matrices C and D are constant for a whole dive: C
/// changes the direction of travel, D takes part of a rotation for a translation. One sigma of each entry.
/// Dives with a real rig's errors shifted by 2 to 3 cm in every half turn 2 m from the wall, in the same
/// direction in every run. They also shifted by 3 mm in every metre. Dives without these errors shifted by a
/// tenth of the former and a third of the latter.
constexpr double kWayPerWaySigma = 0.003;
constexpr double kWayPerTurnSigma = 0.005;
/// With the same intrinsics the estimate of a rotation w is w + E w, and later headings carry that error. One
/// sigma of each entry of E: first by images alone, where the gyroscope's axes are estimated as well; second
/// with a gyroscope whose axes are known, which halves it (simulated half turns came out 0.04 to 0.27 % wrong
/// with it).
constexpr double kTurnPerTurnSigma = 0.004;
constexpr double kHeldTurnPerTurnSigma = 0.002;
/// With one camera, a translation v also adds a rotation F v to the estimate: points that pass a tilted
/// window drift sideways, and no second camera contradicts that drift. One sigma of each entry of F. A window
/// tilted by 1.3 degrees leaves 0.35 px after the best fit of a file. That corresponds to 0.005 degrees/s at
/// 0.25 m/s in a passage of points; a simulated dive behind such a window turned by 2.2 degrees in 70 m.
constexpr double kTurnPerWaySigma_rad_per_m = 2e-4;
/// Upper limit of the effect of these errors on the height with a pressure sensor; 1 sigma.
constexpr double kHeldHeightSigma_m = 0.05;

/// The sensors that determine a frame's estimate, as CovarianceInflation needs them.
struct EstimateSources {
  bool is_scale_given = false;  ///< by a second camera
  /// Sigma of the density ratio that scales a pressure sensor's heights, beyond the part that the covariance
  /// contains; empty without such a sensor.
  std::optional<double> density_sigma = std::nullopt;
  bool has_magnetometer = false;  ///< which determines the heading, whatever the errors of rotations are
  bool are_gyroscope_axes_known = true;  ///< calibrated by their maker, or held
};

/// Sigma of the density ratio beyond the covariance; see DepthOptions::least_density_sigma. Zero where the
/// cameras' calibration is not estimated.
double unmodelledDensitySigma(const EstimatorOptions& options);

/// Covariance of the positions and headings that errors of the intrinsics without a state cause along the
/// rig's path. It enlarges the reported covariance and does not change the estimate. It is zero where the
/// cameras' calibration is not estimated (CameraCalibrationOptions::enabled).
class CovarianceInflation {
 public:
  explicit CovarianceInflation(const EstimatorOptions& options) : options_(options) {}

  /// Adds the next pose of the path. `scene_distance_m`: distance of the observed scene from there (m); where
  /// empty, the last known distance remains in use.
  void follow(const Rigid3& world_from_body, std::optional<double> scene_distance_m);

  /// Adds this covariance to that of the newest pose's state (pose first, world axes).
  void addTo(const EstimateSources& sources, Eigen::Matrix<double, 15, 15>* covariance) const;

  /// A with A A^T = what addTo() adds to the covariance of [dp, dtheta]: one column for each independent
  /// error, times its sigma. The errors of all frames of a path are the same, so the columns of two frames
  /// also have their cross-covariance.
  Eigen::Matrix<double, 6, Eigen::Dynamic> root(const EstimateSources& sources) const;
  static constexpr int kErrors = 38;  ///< columns of root()

 private:
  /// Derivatives, by the entries of E, of the heading and of the horizontal position for heading errors E c.
  /// c is the motion that causes the error (rotation or translation) in body axes; x and y are world axes.
  struct Bend {
    Mat3 heading = Mat3::Zero(), x = Mat3::Zero(), y = Mat3::Zero();

    void follow(const Vec3& cause_B, const Mat3& world_from_body, const Vec3& step_W);
  };

  EstimatorOptions options_;
  std::optional<Rigid3> newest_;
  double scene_distance_m_ = 0.0;
  /// d p_W / d C and d p_W / d D, one column of C or D in each: sums of R v_k and of R d w_k.
  std::array<Mat3, 3> by_way_{Mat3::Zero(), Mat3::Zero(), Mat3::Zero()};
  std::array<Mat3, 3> by_turn_{Mat3::Zero(), Mat3::Zero(), Mat3::Zero()};
  Bend bent_by_turns_, bent_by_the_way_;
};

/// Adds a heading error of the whole world about its origin, one sigma, to the covariance of a state as
/// above.
void addHeadingError(double sigma_rad, const NavigationState& state,
                     Eigen::Matrix<double, 15, 15>* covariance);

}  // namespace lodeline
