#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "lodeline/estimator/visual/camera_to_body_chain_rule.h"
#include "lodeline/estimator/visual/camera_views.h"
#include "lodeline/estimator/visual/reprojection_hessian.h"
#include "lodeline/factors/rolling_shutter.h"
#include "lodeline/problem/normal_equations.h"

namespace lodeline {

/// All reprojection residuals of a window at once. Cost and derivatives equal those of the factors of
/// FactorBuilder::landmark(), which remain the reference, at a fraction of the computing time. Landmarks are
/// eliminated with respect to camera poses, of which each frame has one. The chain rule to body poses and
/// calibration is applied once to the sum and not to every observation.
class ReprojectionSystem {
 public:
  /// All landmarks of the window, or those without or with a linearization in LandmarkLinearizationCache.
  enum class Of { kAll, kLive, kFrozen };

  /// Window and factors must outlive the terms, and tracks must not change. With `only`, the terms contain
  /// only the observations of that frame.
  ReprojectionSystem(Window& window, const FactorBuilder& factors, Of which = Of::kAll,
                     std::optional<FrameId> only = {});
  ReprojectionSystem(const ReprojectionSystem&) = delete;
  ReprojectionSystem& operator=(const ReprojectionSystem&) = delete;

  /// Linearizes at the blocks' present values; to be called after they have changed. All of the following
  /// functions use the values of the last call, or first those at construction.
  void update();

  double cost() const;

  /// Norm of the whitened residual of every observation, landmarks in the order of their tracks.
  std::vector<double> errors() const;

  /// Parameter blocks of the landmarks in that order.
  std::vector<double*> landmarks() const;

  /// Adds the terms with eliminated landmarks. Jacobians are taken at the blocks' linearization points where
  /// they have one.
  void addTo(NormalEquations* system);

  /// Updates the landmarks for a step of `system`, to which the terms were added last.
  void stepLandmarks(const NormalEquations& system, const Eigen::VectorXd& step);

 private:
  using Vec6 = Eigen::Matrix<double, 6, 1>;
  struct Observation {
    int frame, camera;
    const DirectionMeasurement* measurement;
    double scale_squared;                     ///< of the robust loss
    const DirectionMeasurement* as_measured;  ///< `measurement` is that at the time of the image
  };
  struct Landmark {
    double* value;
    int host;
    LandmarkBase base;
    double weight;  ///< of its squared residuals
    size_t first_observation, end_observation;
    int first_frame, end_frame;  ///< range of the frames that observe it, including its host
    Eigen::Index column;         ///< of its couplings
    Mat3 inverse_root;           ///< of the last linearization: W with W W^T the inverse of its Hessian
  };
  /// Landmarks with adjacent columns of couplings, and the range of frames that observe any of them.
  struct Stretch {
    std::vector<Landmark*> landmarks;
    Eigen::Index column, columns;
    int first_frame, end_frame;
  };
  /// Residuals of an observation, by the intrinsics of the calibration file and by the estimated ones.
  struct Residual {
    Vec2 by_file, by_intrinsics;
  };
  struct Linearized;

  Linearized linearize(const Landmark& landmark, const Observation& observation,
                       const Residual& residual) const;
  void add(FeatureTrack& track, std::optional<FrameId> only, const std::vector<FrameId>& ids,
           const std::vector<double>& scales);
  void arrangeColumns();
  void eliminate(Landmark* landmark);
  void subtractEliminated(const Stretch& stretch);
  void addPair(int host, int target);
  void addCalibration(int camera);
  size_t indexOf(int host, int target, int camera) const {
    return static_cast<size_t>((host * frames_ + target) * cameras_ + camera);
  }
  auto couplingsOfFrames(const Stretch& stretch) {
    return couplings_.block(6 * stretch.first_frame, stretch.column,
                            6 * (stretch.end_frame - stretch.first_frame), stretch.columns);
  }
  auto couplingsOfCalibration(const Stretch& stretch) {
    return couplings_.block(6 * frames_, stretch.column, rows_ - 6 * frames_, stretch.columns);
  }
  /// Vector from a target's camera 0 to a host's.
  Vec3 baseline_W(int host, int target) const {
    return first_.placement(host).position_W - first_.placement(target).position_W;
  }
  /// First rows of a camera's extrinsics and intrinsics.
  int secondaryRow(int camera) const { return 6 * (frames_ + camera - 1); }
  int intrinsicsRow(int camera) const { return secondaryRow(cameras_) + kIntrinsicsSize * camera; }
  int shutterRow() const {
    return intrinsicsRow(0) + kIntrinsicsSize * static_cast<int>(states_.intrinsics.size());
  }
  double lineDelay_s(int camera) const { return states_.shutter->value[static_cast<size_t>(camera)]; }
  const CameraMotion& motionOf(const Observation& observation) const {
    return motions_[static_cast<size_t>(observation.frame * cameras_ + observation.camera)];
  }
  void prepareShutter(const Window& window, const FactorBuilder& factors);
  /// Moves the measurements to the time of their images by the present line delays.
  void moveMeasurements();
  void addShutter();
  const double* intrinsicsOf(int camera) const {
    return states_.intrinsics[static_cast<size_t>(camera)]->value.data();
  }

  CameraStates states_;
  CameraViews values_;
  CameraViews first_;
  int frames_;
  int cameras_;
  int rows_;
  CameraToBodyChainRule blocks_;
  std::vector<Landmark> landmarks_;
  std::vector<Stretch> stretches_;
  std::vector<Observation> observations_;
  std::vector<Residual> residuals_;  ///< of the observations
  // For rolling shutters only:
  std::vector<CameraMotion> motions_;        ///< by frame and camera
  std::vector<DirectionMeasurement> moved_;  ///< measurements at the time of the images
  std::vector<Vec2> shutter_products_;       ///< by camera: squared derivative, and times the residual
  // Nodes are the variables with respect to which landmarks are eliminated, `rows_` coordinates in all:
  // camera poses in the window's order, extrinsics of secondary cameras, intrinsics where estimated, the line
  // delays of six cameras where a shutter is rolling.
  std::vector<HostProducts> by_host_;                ///< by indexOf()
  std::vector<CalibrationProducts> by_calibration_;  ///< by camera
  Eigen::MatrixXd hessian_;                          ///< of the nodes; lower triangle
  Eigen::VectorXd gradient_;
  /// Couplings of nodes (rows) and landmarks (columns), times the landmarks' inverse roots. Rows of frames
  /// outside a stretch's range are undefined.
  Eigen::MatrixXd couplings_;
  Eigen::VectorXd rooted_gradients_;  ///< gradients by the landmarks, times the transposed inverse roots
};

}  // namespace lodeline
