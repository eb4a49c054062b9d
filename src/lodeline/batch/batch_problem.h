#pragma once

#include <functional>
#include <map>
#include <memory>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "lodeline/batch/batch_landmarks.h"
#include "lodeline/batch/block_skyline_cholesky.h"
#include "lodeline/batch/estimator_log.h"
#include "lodeline/batch/joined_landmarks.h"
#include "lodeline/batch/state_order.h"
#include "lodeline/batch/time_correlated_errors.h"
#include "lodeline/estimator/magnetometer/heading_alignment.h"
#include "lodeline/problem/factor_builder.h"
#include "lodeline/problem/normal_equations.h"
#include "lodeline/problem/state/window.h"

namespace lodeline {

/// Least-squares problem of a whole recording: the terms of the sliding window
/// (problem/factor_builder.h) over all states at once, without marginalization and without
/// linearization points. Offsets that walk (magnetometer, pressure gauge) are chains of states, one per
/// minute.
class BatchProblem {
 public:
  /// Initial values: states from the forward run, landmarks triangulated with its poses. Observations that
  /// contradict these are left out from the start. `rig` and `options` as in the forward run; all arguments
  /// must outlive the problem. With loops, the states start from their initial poses (InitialCorrection), and
  /// landmarks are joined with a `loosening` (joinLandmarks()).
  BatchProblem(const Rig& rig, const EstimatorOptions& options, const EstimatorLog& record,
               const LoopClosures& loops = {}, double loosening = 1.0);
  BatchProblem(const BatchProblem&) = delete;  // its parts refer to each other
  BatchProblem& operator=(const BatchProblem&) = delete;

  size_t states() const { return window_.frames().size(); }
  size_t landmarks() const;
  size_t observations() const;
  const Frame& state(size_t index) const { return *window_.frames()[index]; }
  const Window& window() const { return window_; }
  const FactorBuilder& factors() const { return factors_; }

  /// Links of loop observations (LoopLink): all, and those that join landmarks at present.
  int links() const { return static_cast<int>(links_.size()); }
  int linksUsed() const { return joined_.links_used; }
  /// Sets the `loosening` with which renewLandmarks() joins landmarks from now on.
  void tightenLoops(double loosening) { loosening_ = loosening; }

  /// A zero matrix with the blocks of the problem in their order. With loops, renewLandmarks() changes it.
  BlockSkylineCholesky emptyMatrix() const { return BlockSkylineCholesky(sizes_, first_); }

  /// Cost at the present values.
  double cost();
  /// Computes the Gauss-Newton system H d = -g, landmarks eliminated.
  void linearize(BlockSkylineCholesky* hessian, Eigen::VectorXd* gradient);
  /// Subtracts from the Hessian the information that the estimate uses and the reported covariance leaves out
  /// (estimator/uncertainty/reported_covariance.h), before the Hessian is inverted for covariances.
  void subtractRemoved(BlockSkylineCholesky* hessian) const;
  /// Applies a step of the last linearized system to all values, which must not have changed since.
  void step(const Eigen::VectorXd& step);
  /// All values, as a backup for setValues().
  std::vector<double> values();
  void setValues(const std::vector<double>& values);

  /// Updates quantities that are constant during small changes of the values: preintegrations and the motion
  /// at the images. Changes the cost.
  void resetLinearizationPoints();
  /// Triangulates all landmarks again with the present poses and removes the observations that contradict
  /// them, whatever was removed before. Sets the width of the robust loss from the residuals. Returns the
  /// share of removed observations.
  double renewLandmarks();
  /// Statistics of the residuals at the present values, without those to which the robust loss gives little
  /// weight.
  TimeCorrelatedErrors timeCorrelatedErrors();
  /// Multiplies the variance of the observations by `variance`, until landmarks are renewed.
  void weighObservations(double variance);

  /// Product L x of the information L that loops add to the system, i.e. that of joined landmarks less that
  /// of their parts alone, with changes x of all poses: 6 rows [dp, dtheta] for each state, any columns.
  Eigen::MatrixXd loopInformationTimes(const std::vector<Eigen::MatrixXd>& pose_changes);
  /// Rows of a state's [dp, dtheta] in the system.
  int poseOffset(size_t state, const BlockSkylineCholesky& matrix) const {
    return matrix.offset(rowOf(this->state(state).pose.data()));
  }

  /// Value of a sensor's walking parameter block that is valid for a state; null where there is none.
  const double* walkingValue(std::string_view name, size_t state) const;

  /// Covariance of a state's [dp, dtheta, dv, db_g, db_a], from the inverse of the system.
  Eigen::Matrix<double, 15, 15> covarianceOf(size_t state, const BlockSkylineCholesky& inverse) const;
  /// Claimed errors of the ports of all cameras (PortCorrection); empty where none is estimated.
  std::vector<Vec3> portSigmas(const BlockSkylineCholesky& inverse) const;
  /// Covariance of the field's azimuth, and with a state; zero where the field is not a state.
  AzimuthCovariance azimuth(size_t state, const BlockSkylineCholesky& inverse) const;

 private:
  /// Longer tracks are split: the states of a track form a clique, and a rig at rest would connect thousands.
  static constexpr size_t kLongestTrack = 40;
  using GlobalValues = std::map<std::string, std::vector<double>>;
  void addStates(const Rig& rig, const EstimatorLog& record, const std::vector<InitialPose>& initial_poses);
  void addTracks(const EstimatorLog& record, const std::vector<LoopObservation>& loops);
  void addGlobals(const EstimatorLog& record);
  void addStartPrior(const EstimatorLog& record);
  /// Adds the intrinsics and ports. Without a port, the intrinsics are held at the final values of the run
  /// (`globals`). If they were free, they would follow points that slide in the images along a barely
  /// observable mode: a longer focal length with a camera further back. Behind a port, these values contain
  /// the error of the port, so the intrinsics have the prior of their file. The port takes the place of the
  /// coefficients of a tilted port.
  void addLenses(const Rig& rig, const GlobalValues& globals);
  /// Holds the files or frees them, as the run did in the end.
  void believeInFilesAsBefore(const EstimatorLog& record);
  void addImuAxes(const GlobalValues& globals);
  ParameterBlock* addGlobal(const EstimatorLog& record, const std::string& name, const std::string& as);
  /// Adds the prior of a sensor's parameter block (BatchState::sigma).
  void addKnowledge(ParameterBlock* state, const BatchState& of);
  bool isLoosened(TrackId track) const { return loosening_ != 1.0 && joined_.contains(track); }
  /// States that terms connect, beside a sensor's measurements on landmarks.
  StateCliques cliques() const;
  std::vector<std::vector<size_t>> neighbours() const;
  void orderBlocks();
  void appendBlock(double* value, int tangent_size, int first);
  std::vector<Factor> motionFactors();
  template <typename Visit>
  void forEachValue(const Visit& visit);
  int rowOf(const double* value) const { return rows_.at(value); }
  void scatter(const NormalEquations& local, BlockSkylineCholesky* hessian, Eigen::VectorXd* gradient) const;

  /// Part of a chain: valid for the states from `first` on.
  struct Node {
    size_t first = 0;
    ParameterBlock* state = nullptr;
    bool continues = false;  ///< whether the walk of the node before continues in it
  };
  using Chain = std::vector<Node>;
  size_t endOf(const Chain& chain, size_t node) const;  ///< state after the last one for which it is valid
  Chain makeChain(const EstimatorLog& record, const RecordedSensorState& recorded);
  void addWalk(const Chain& chain, double walk_per_sqrt_s);
  static double* nodeOf(const Chain& chain, size_t state);
  /// Terms of a state's sensors, with the nodes of the chains that are valid for it: those on landmarks, or
  /// the others.
  void addSensorFactors(size_t k, bool on_landmarks, std::vector<Factor>* terms);
  /// Makes the sensors' terms on landmarks. They stay the same while the cost is minimized.
  void renewLandmarkFactors();
  /// Calls `visit` with each term without reprojection terms.
  void forEachFactor(const std::function<void(const Factor&)>& visit);

  EstimatorOptions options_;
  std::vector<std::shared_ptr<const Camera>> cameras_;
  FactorBuilder factors_;
  std::shared_ptr<const ceres::LossFunction> loss_;  ///< for the residuals of sensors
  Window window_;
  BatchLandmarks visual_;
  std::vector<Factor> landmark_factors_;
  Tracks all_tracks_;  ///< with all their observations, without landmarks
  std::vector<LoopLink> links_;
  double loosening_ = 1.0;
  JoinedLandmarks joined_;
  std::vector<Prior> priors_;
  std::vector<Chain> chains_;  ///< not empty; the first node has the name of the parameter block
  // Blocks in the order of the system:
  std::unordered_map<const double*, int> rows_;
  std::vector<int> sizes_, first_;
};

}  // namespace lodeline
