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
  using Mat63 = Eigen::Matrix<double, 6, 3>;
  using Vec6 = Eigen::Matrix<double, 6, 1>;
  struct Sighting {
    int frame, camera;
    const DirectionMeasurement* measurement;
    double scale_squared;  ///< of the robust loss
  };
  /// Nodes are what landmarks are eliminated against: the camera poses of the frames in the window's order,
  /// then the extrinsics of further cameras, then the lenses where they are estimated.
  struct Coupling {
    int node;
    Mat63 by_landmark;
  };
  struct Landmark {
    double* value;
    int host;
    LandmarkBase base;
    size_t first_sighting, end_sighting;
    // Of the last linearisation:
    size_t first_coupling, end_coupling;
    Mat3 inverse_hessian;
    Vec3 gradient;
  };
  struct Linearised;

  Linearised linearise(const Landmark& landmark, const Sighting& sighting) const;
  void eliminate(Landmark* landmark);
  Coupling& couplingOf(const Landmark& landmark, int node);
  Mat6& hessian(int row, int column);
  void addProduct(int a, const Eigen::Matrix<double, 2, 6>& by_a, int b,
                  const Eigen::Matrix<double, 2, 6>& by_b);
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
  std::vector<Coupling> couplings_;
  std::vector<Mat6> hessian_;  ///< lower triangle of blocks, node by node
  std::vector<Vec6> gradient_;
};

}  // namespace lodeline
