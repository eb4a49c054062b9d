#pragma once

#include <map>
#include <memory>
#include <unordered_map>
#include <vector>

#include "lodeline/batch/batch_landmarks.h"
#include "lodeline/batch/block_skyline_cholesky.h"
#include "lodeline/batch/estimator_log.h"
#include "lodeline/batch/time_correlated_errors.h"
#include "lodeline/estimator/magnetometer/heading_alignment.h"
#include "lodeline/estimator/problem/factor_builder.h"
#include "lodeline/estimator/problem/normal_equations.h"
#include "lodeline/estimator/state/window.h"

namespace lodeline {

/// The least-squares problem of a whole recording: the terms of the sliding window
/// (estimator/factor_builder.h) over all states at once, with nothing marginalized and no linearization
/// points. Offsets that wander, of the magnetometer and of the pressure gauge, are a chain of states, one a
/// minute.
class BatchProblem {
 public:
  /// States start where the forward run left them, landmarks where its poses see them. Observations that
  /// contradict those are left out from the start. `rig` and `options` as of the forward run; everything must
  /// outlive the problem.
  BatchProblem(const Rig& rig, const EstimatorOptions& options, const EstimatorLog& record);
  BatchProblem(const BatchProblem&) = delete;  // its parts refer to each other
  BatchProblem& operator=(const BatchProblem&) = delete;

  size_t states() const { return window_.frames().size(); }
  size_t landmarks() const;
  size_t observations() const;
  const Frame& state(size_t index) const { return *window_.frames()[index]; }
  const Window& window() const { return window_; }
  const FactorBuilder& factors() const { return factors_; }

  /// An empty matrix in the order of the problem's blocks.
  BlockSkylineCholesky emptyMatrix() const { return BlockSkylineCholesky(sizes_, first_); }

  /// At the present values.
  double cost();
  /// The Gauss-Newton system H d = -g, landmarks eliminated.
  void linearize(BlockSkylineCholesky* hessian, Eigen::VectorXd* gradient);
  /// Takes from the Hessian what is known and not claimed (estimator/reported_covariance.h), before it is
  /// inverted for covariances.
  void subtractRemoved(BlockSkylineCholesky* hessian) const;
  /// Moves everything by a step of the system linearized last; no value may have moved since.
  void step(const Eigen::VectorXd& step);
  /// All values, to go back to.
  std::vector<double> values();
  void setValues(const std::vector<double>& values);

  /// Brings up to date what is held while the values move a little: preintegrations and the motion at the
  /// images. Changes the cost.
  void resetLinearizationPoints();
  /// Places all landmarks anew by the present poses and leaves out the observations that contradict them,
  /// whatever was left out before. The robust loss becomes as wide as the errors ask. Returns the share of
  /// the observations that went.
  double renewLandmarks();
  /// The errors at the present values, without those that the robust loss hardly counts.
  TimeCorrelatedErrors timeCorrelatedErrors();
  /// Gives observations so many times their variance, until landmarks are renewed.
  void weighObservations(double variance);

  /// The offset of the magnetometer's corrected readings (T) and the depth at the origin (m) that are in
  /// force for a state; null where there is no such sensor.
  const double* fieldOffset(size_t state) const { return nodeOf(field_offsets_, state); }
  const double* depthOffset(size_t state) const { return nodeOf(depth_offsets_, state); }

  /// Of a state's [dp, dtheta, dv, db_g, db_a], from the inverse of the system.
  Eigen::Matrix<double, 15, 15> covarianceOf(size_t state, const BlockSkylineCholesky& inverse) const;
  /// Of the field's azimuth, and with a state; zero where the field is no state.
  AzimuthCovariance azimuth(size_t state, const BlockSkylineCholesky& inverse) const;

 private:
  using GlobalValues = std::map<std::string, std::vector<double>>;
  void addStates(const Rig& rig, const EstimatorLog& record);
  void addTracks(const EstimatorLog& record);
  void addGlobals(const EstimatorLog& record);
  void addStartPrior(const Rig& rig, const EstimatorLog& record);
  /// Lenses stay as the run found them (`globals`). Free, they follow what slides in the images along a mode
  /// that is hardly known: a longer lens whose camera sits further back.
  void holdIntrinsics(const GlobalValues& globals);
  /// Or does not, as the run did in the end.
  void believeInFilesAsBefore(const EstimatorLog& record);
  void addImuAxes(const GlobalValues& globals);
  ParameterBlock* addGlobal(const EstimatorLog& record, const std::string& name, const std::string& as);
  void addKnowledge(ParameterBlock* state, double sigma);
  void orderBlocks();
  void appendBlock(double* value, int tangent_size, int first);
  std::vector<Factor> motionFactors();
  template <typename Visit>
  void forEachValue(const Visit& visit);
  int rowOf(const double* value) const { return rows_.at(value); }
  void scatter(const NormalEquations& local, BlockSkylineCholesky* hessian, Eigen::VectorXd* gradient) const;

  /// Part of a chain: in force for the states from `first` on.
  struct Node {
    size_t first = 0;
    ParameterBlock* state = nullptr;
    bool continues = false;  ///< the walk from the node before
  };
  using Chain = std::vector<Node>;
  void addChain(const EstimatorLog& record, const char* name, bool restarts, Chain* chain);
  void addWalk(const Chain& chain, double walk_per_sqrt_s);
  static double* nodeOf(const Chain& chain, size_t state);

  EstimatorOptions options_;
  std::vector<std::shared_ptr<const Camera>> cameras_;
  FactorBuilder factors_;
  std::shared_ptr<const ceres::LossFunction> loss_;  ///< on magnetometer and depth
  Window window_;
  BatchLandmarks visual_;
  Tracks all_tracks_;  ///< with all their observations, without landmarks
  std::vector<Prior> priors_;
  Chain field_offsets_, depth_offsets_;
  // Blocks in the order of the system:
  std::unordered_map<const double*, int> rows_;
  std::vector<int> sizes_, first_;
};

}  // namespace lodeline
