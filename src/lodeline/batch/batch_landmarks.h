#pragma once

#include <functional>
#include <vector>

#include "lodeline/problem/normal_equations.h"
#include "lodeline/problem/state/window.h"

namespace lodeline {

/// The reprojection terms of a whole recording. They are computed on all cores in groups of landmarks whose
/// tracks began close together in time and share most of their states. Sums are taken in the order of the
/// groups, so that any number of cores gives the same bytes.
class BatchLandmarks {
 public:
  /// Both must outlive this object. There are no terms before the first arrange().
  BatchLandmarks(Window& window, const FactorBuilder& factors) : window_(window), factors_(factors) {}

  /// Updates the groups from the present landmarks of the window's tracks: to be called after landmarks were
  /// added or removed.
  void arrange();

  double cost() const;

  /// Passes the Gauss-Newton system of every group, landmarks eliminated, to `take`, in order.
  void linearize(const std::function<void(const NormalEquations&)>& take);

  /// Updates the landmarks for a step of the other blocks; `stepOf` selects the part of the step for a
  /// system. To be called after linearize(), before any value has changed. `stepOf` is called from several
  /// threads.
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
