#pragma once

#include <Eigen/Core>
#include <vector>

#include "lodeline/estimator/camera_views.h"
#include "lodeline/estimator/normal_equations.h"

namespace lodeline {

/// All reprojection terms of a window at once: the same cost and derivatives as the factors of
/// FactorMaker::landmark(), which remain the reference, at a fraction of their price. Landmarks are
/// eliminated against the poses of the cameras, of which each frame has one; what those mean for the poses of
/// the bodies and for the calibration is worked out once for the sum, not for every sighting.
class VisualTerms {
 public:
  /// Window and factors must outlive the terms, and tracks must stay as they are.
  VisualTerms(Window& window, const FactorMaker& factors);

  /// At the blocks' present values.
  double cost();

  /// Length of the whitened error of every sighting at the values of the last cost() or addTo() (or of
  /// the construction), landmarks in the order of their tracks.
  std::vector<double> errors() const;

  /// Adds the terms, landmarks eliminated. Jacobians are taken at first estimates where blocks hold them.
  void addTo(NormalEquations* system);

  /// Moves the landmarks along with a step of `system`, to which the terms were added last.
  void stepLandmarks(const NormalEquations& system, const Eigen::VectorXd& step);

 private:
  using Vec6 = Eigen::Matrix<double, 6, 1>;
  struct Sighting {
    int frame, camera;
    const DirectionMeasurement* measurement;
    double scale_squared;  ///< of the robust loss
  };
  struct Landmark {
    double* value;
    int host;
    LandmarkBase base;
    size_t first_sighting, end_sighting;
    Mat3 inverse_root;  ///< of the last linearisation: W with W W^T the inverse of its Hessian
  };
  /// What the sightings in a target frame of landmarks of a host frame add up to, by the pose of the host's
  /// camera 0. The target's pose moves a sighting like the host's, backwards and from another centre, the
  /// same for all of them, so it is worked out for the sum (addPairs()).
  struct Pair {
    bool is_seen = false;
    Mat6 hessian = Mat6::Zero();
    Vec6 gradient = Vec6::Zero();
  };
  struct Linearised;

  Linearised linearise(const Landmark& landmark, const Sighting& sighting) const;
  void eliminate(size_t landmark);
  void addPairs();
  int pairOf(int host, int target) const { return host * frames_ + target; }
  /// From a target's camera 0 to a host's.
  Vec3 baseline_W(int host, int target) const {
    return first_.placement(host).position_W - first_.placement(target).position_W;
  }
  int furtherNode(int camera) const { return frames_ + camera - 1; }
  int lensNode(int camera) const { return frames_ + static_cast<int>(states_.further.size()) + camera; }
  Vec2 residual(const Landmark& landmark, const Sighting& sighting) const;
  void addNodesTo(NormalEquations* system) const;
  std::vector<NormalEquations::Block> blocks() const;

  const Window& window_;
  CameraStates states_;
  CameraViews values_;
  CameraViews first_;
  int frames_;
  int nodes_;
  std::vector<Landmark> landmarks_;
  std::vector<Sighting> sightings_;
  // Nodes are what landmarks are eliminated against, six coordinates each: the camera poses of the frames in
  // the window's order, then the extrinsics of further cameras, then the lenses where they are estimated.
  std::vector<Pair> pairs_;      ///< by pairOf()
  Eigen::MatrixXd calibration_;  ///< as Pair::hessian, of all other nodes (rows) and the pairs' hosts
  Eigen::MatrixXd hessian_;      ///< of the nodes; lower triangle
  Eigen::VectorXd gradient_;
  Eigen::MatrixXd couplings_;         ///< of nodes (rows) and landmarks, times the latter's inverse roots
  Eigen::VectorXd rooted_gradients_;  ///< of landmarks, by the transposed inverse roots
};

}  // namespace lodeline
