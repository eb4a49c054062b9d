#pragma once

#include <map>
#include <memory>
#include <unordered_map>
#include <vector>

#include "lodeline/batch/batch_landmarks.h"
#include "lodeline/batch/forward_record.h"
#include "lodeline/batch/lasting_errors.h"
#include "lodeline/batch/skyline_matrix.h"
#include "lodeline/estimator/magnetometer/heading_alignment.h"
#include "lodeline/estimator/problem/factor_list.h"
#include "lodeline/estimator/problem/normal_equations.h"
#include "lodeline/estimator/state/window.h"

namespace lodeline {

/// The least-squares problem of a whole recording: the terms of the sliding window (estimator/factor_list.h)
/// over all states at once, with nothing marginalised and no first estimates. Offsets that wander, of the
/// magnetometer and of the pressure gauge, are a chain of states, one a minute.
class BatchProblem {
 public:
  /// States start where the forward run left them, landmarks where its poses see them. Sightings that
  /// contradict those are left out from the start. `rig` and `options` as of the forward run; everything must
  /// outlive the problem.
  BatchProblem(const Rig& rig, const EstimatorOptions& options, const ForwardRecord& record);
  BatchProblem(const BatchProblem&) = delete;  // its parts refer to each other
  BatchProblem& operator=(const BatchProblem&) = delete;

  size_t states() const { return window_.frames().size(); }
  size_t landmarks() const;
  size_t sightings() const;
  const Frame& state(size_t index) const { return *window_.frames()[index]; }
  const Window& window() const { return window_; }
  const FactorMaker& factors() const { return factors_; }

  /// An empty matrix in the order of the problem's blocks.
  SkylineMatrix emptyMatrix() const { return SkylineMatrix(sizes_, first_); }

  /// At the present values.
  double cost();
  /// The Gauss-Newton system H d = -g, landmarks eliminated.
  void linearise(SkylineMatrix* hessian, Eigen::VectorXd* gradient);
  /// Takes from the Hessian what is known and not claimed (estimator/claimed_covariance.h), before it is
  /// inverted for covariances.
  void subtractUnclaimed(SkylineMatrix* hessian) const;
  /// Moves everything by a step of the system linearised last; no value may have moved since.
  void step(const Eigen::VectorXd& step);
  /// All values, to go back to.
  std::vector<double> values();
  void setValues(const std::vector<double>& values);

  /// Brings up to date what is held while the values move a little: preintegrations and the motion at the
  /// images. Changes the cost.
  void relinearise();
  /// Places all landmarks anew by the present poses and leaves out the sightings that contradict them,
  /// whatever was left out before. The robust loss becomes as wide as the errors ask. Returns the share of
  /// the sightings that went.
  double renewLandmarks();
  /// The errors at the present values, without those that the robust loss hardly counts.
  LastingErrors lastingErrors();
  /// Gives sightings so many times their variance, until landmarks are renewed.
  void weighSightings(double variance);

  /// The offset of the magnetometer's corrected readings (T) and the depth at the origin (m) that are in
  /// force for a state; null where there is no such sensor.
  const double* fieldOffset(size_t state) const { return nodeOf(field_offsets_, state); }
  const double* depthOffset(size_t state) const { return nodeOf(depth_offsets_, state); }

  /// Of a state's [dp, dtheta, dv, db_g, db_a], from the inverse of the system.
  Eigen::Matrix<double, 15, 15> covarianceOf(size_t state, const SkylineMatrix& inverse) const;
  /// Of the field's azimuth, and with a state; zero where the field is no state.
  AzimuthCovariance azimuth(size_t state, const SkylineMatrix& inverse) const;

 private:
  using GlobalValues = std::map<std::string, std::vector<double>>;
  void addStates(const Rig& rig, const ForwardRecord& record);
  void addTracks(const ForwardRecord& record);
  void addGlobals(const ForwardRecord& record);
  void addStartPrior(const Rig& rig, const ForwardRecord& record);
  /// Lenses stay as the run found them (`globals`). Free, they follow what slides in the images along a mode
  /// that is hardly known: a longer lens whose camera sits further back.
  void holdLenses(const GlobalValues& globals);
  /// Or does not, as the run did in the end.
  void believeInFilesAsBefore(const ForwardRecord& record);
  void addImuAxes(const GlobalValues& globals);
  GlobalState* addGlobal(const ForwardRecord& record, const std::string& name, const std::string& as);
  void addKnowledge(GlobalState* state, double sigma);
  void orderBlocks();
  void appendBlock(double* value, int tangent_size, int first);
  std::vector<Factor> motionFactors();
  template <typename Visit>
  void forEachValue(const Visit& visit);
  int rowOf(const double* value) const { return rows_.at(value); }
  void scatter(const NormalEquations& local, SkylineMatrix* hessian, Eigen::VectorXd* gradient) const;

  /// Part of a chain: in force for the states from `first` on.
  struct Node {
    size_t first = 0;
    GlobalState* state = nullptr;
    bool continues = false;  ///< the walk from the node before
  };
  using Chain = std::vector<Node>;
  void addChain(const ForwardRecord& record, const char* name, bool restarts, Chain* chain);
  void addWalk(const Chain& chain, double walk_per_sqrt_s);
  static double* nodeOf(const Chain& chain, size_t state);

  EstimatorOptions options_;
  std::vector<std::shared_ptr<const Camera>> cameras_;
  FactorMaker factors_;
  std::shared_ptr<const ceres::LossFunction> loss_;  ///< on magnetometer and depth
  Window window_;
  BatchLandmarks visual_;
  Tracks all_tracks_;  ///< with all their sightings, without landmarks
  std::vector<Prior> priors_;
  Chain field_offsets_, depth_offsets_;
  // Blocks in the order of the system:
  std::unordered_map<const double*, int> rows_;
  std::vector<int> sizes_, first_;
};

}  // namespace lodeline
