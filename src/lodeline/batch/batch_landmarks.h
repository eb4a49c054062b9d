#pragma once

#include <functional>
#include <vector>

#include "lodeline/estimator/problem/normal_equations.h"
#include "lodeline/estimator/state/window.h"

namespace lodeline {

/// The reprojection terms of a whole recording, worked out on all cores in stretches of landmarks whose
/// tracks began side by side, which share most of their states. Sums are taken in the order of the stretches:
/// any number of cores gives the same bytes.
class BatchLandmarks {
 public:
  /// Both must outlive this. There are no terms before the first arrange().
  BatchLandmarks(Window& window, const FactorBuilder& factors) : window_(window), factors_(factors) {}

  /// Takes the landmarks that the window's tracks have now: to be called after any came or went.
  void arrange();

  double cost() const;

  /// Gives every stretch's Gauss-Newton system, landmarks eliminated, to `take`, which is called in order.
  void linearize(const std::function<void(const NormalEquations&)>& take);

  /// Moves the landmarks along with a step of the other blocks, of which `stepOf` picks those of a system. To
  /// be called after linearize(), before any value has moved. `stepOf` is called from several threads.
  void step(const std::function<Eigen::VectorXd(const NormalEquations&)>& stepOf) const;

 private:
  struct Stretch {
    std::vector<FeatureTrack*> tracks;
    NormalEquations system;
  };

  Window& window_;
  const FactorBuilder& factors_;
  std::vector<Stretch> stretches_;
};

}  // namespace lodeline
