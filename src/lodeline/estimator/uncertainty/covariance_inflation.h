#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

#include "lodeline/estimator/options/options.h"
#include "lodeline/geometry/rigid3.h"
#include "lodeline/imu/propagation.h"

namespace lodeline {

/// Relative sigma of one camera's scale that a lens which is not quite as its file says leaves without a
/// trace in the residuals: part of the flow by the rig's turns, which go with its accelerations, counts as
/// way. Simulated dives with calibrations off by 0.3 % behind a flat port came out 0 to 2 % too small.
constexpr double kOneCameraScaleSigma = 0.01;

/// Such a lens sees a way v as v + C v and a turn w as a way d D w, d the distance of what it sees, with
/// matrices C and D that stay for a whole dive: a bent direction of travel, or part of a turn taken for a
/// slide. One sigma of each entry. Dives with a real rig's errors have slid by 2 to 3 cm in every half turn
/// 2 m from the wall, the same way in every run, and 3 mm in every metre; those without, by a tenth of the
/// former and a third of the latter.
constexpr double kWayPerWaySigma = 0.003;
constexpr double kWayPerTurnSigma = 0.005;
/// The same lens sees a turn w as w + E w, and the heading since is as wrong. One sigma of each entry: by
/// images alone, where the gyroscope's axes are estimated as well, and against a gyroscope whose axes are
/// known, which holds half of it (simulated half turns came out 0.04 to 0.27 % wrong with it).
constexpr double kTurnPerTurnSigma = 0.004;
constexpr double kHeldTurnPerTurnSigma = 0.002;
/// One camera takes a way v for a turn F v besides, for behind a window that is aslant points that pass by
/// drift aside, and no second camera says that they do not. One sigma of each entry. A window 1.3 degrees
/// aslant leaves 0.35 px to the best fit of a file, and that is worth 0.005 degrees/s at 0.25 m/s in a
/// passage of points; a simulated dive behind it turned by 2.2 degrees in 70 m.
constexpr double kTurnPerWaySigma_rad_per_m = 2e-4;
/// With a pressure sensor these errors move the height by no more than this; 1 sigma.
constexpr double kHeldHeightSigma_m = 0.05;

/// What a frame's estimate hangs on, as far as it matters here.
struct EstimateSources {
  bool is_scale_given = false;  ///< by a second camera
  /// Of the ratio of densities by which a pressure sensor tells the height, beyond what the covariance has of
  /// it; nothing without such a sensor.
  std::optional<double> density_sigma = std::nullopt;
  bool has_magnetometer = false;         ///< which tells the heading whatever turns came to
  bool are_gyroscope_axes_known = true;  ///< calibrated by their maker, or held
};

/// Of the density ratio, beyond what the covariance says; see DepthOptions::least_density_sigma.
/// Zero where the cameras' calibration is believed.
double unmodelledDensitySigma(const EstimatorOptions& options);

/// Errors of the lens that no state stands for, and what they make of positions on the way of a rig. They
/// count in what is claimed, not in what is estimated; nothing where the cameras' calibration is believed.
class CovarianceInflation {
 public:
  explicit CovarianceInflation(const EstimatorOptions& options) : options_(options) {}

  /// The next pose on the way, and how far away is what the rig sees from there (m); the last known distance
  /// counts where it sees nothing.
  void follow(const Rigid3& world_from_body, std::optional<double> scene_distance_m);

  /// Adds to the covariance of the newest pose's state (pose first, world axes).
  void addTo(const EstimateSources& sources, Eigen::Matrix<double, 15, 15>* covariance) const;

 private:
  /// Headings that are wrong by E c, for what the rig does, c, in its own axes: derivatives by the entries of
  /// E of the heading, of the way's x and of its y in the world.
  struct Bend {
    Mat3 heading = Mat3::Zero(), x = Mat3::Zero(), y = Mat3::Zero();

    void follow(const Vec3& cause_B, const Mat3& world_from_body, const Vec3& step_W);
    /// One sigma of each entry of E.
    void addTo(double sigma, Eigen::Matrix<double, 15, 15>* covariance) const;
  };

  /// Of p_W by the errors of the way: sum over the entries of both matrices.
  Mat3 byTheWay() const;

  EstimatorOptions options_;
  std::optional<Rigid3> newest_;
  double scene_distance_m_ = 0.0;
  /// d p_W / d C and d p_W / d D, one column of C or D in each: sums of R v_k and of R d w_k.
  std::array<Mat3, 3> by_way_{Mat3::Zero(), Mat3::Zero(), Mat3::Zero()};
  std::array<Mat3, 3> by_turn_{Mat3::Zero(), Mat3::Zero(), Mat3::Zero()};
  Bend bent_by_turns_, bent_by_the_way_;
};

/// Adds an error of the whole world's heading about its origin, one sigma, to the covariance of a state as
/// above.
void addHeadingError(double sigma_rad, const NavigationState& state,
                     Eigen::Matrix<double, 15, 15>* covariance);

}  // namespace lodeline
