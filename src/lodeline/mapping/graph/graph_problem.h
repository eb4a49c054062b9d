#pragma once

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <array>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "lodeline/factors/prior_factor.h"
#include "lodeline/mapping/graph/factors/height_factor.h"
#include "lodeline/mapping/graph/graph_covariance.h"
#include "lodeline/mapping/graph/graph_elements.h"
#include "lodeline/mapping/graph/motion/odometry_chains.h"

namespace lodeline {

/// Multiplies the squared residual of one factor by a weight that changes between solutions.
class WeightLoss final : public ceres::LossFunction {
 public:
  void Evaluate(double squared_norm, double rho[3]) const override {
    rho[0] = weight * squared_norm;
    rho[1] = weight;
    rho[2] = 0.0;
  }
  double weight = 1.0;
};

/// A factor whose residual is reported, and which the solution may refuse where it is robust.
struct ReportedFactor {
  FactorReport::Kind kind = FactorReport::Kind::Loop;
  std::string name;
  KeyframeId from = -1, to = -1;
  bool is_robust = true;
  int degrees_of_freedom = 6;
  bool is_new = true;                           ///< not yet part of a solution
  RelativePose relative;                        ///< measured, of loops
  double gate_chi_squared = 0.0;                ///< of loops, see LoopGate
  bool is_doubtful = false;                     ///< see RobustSolution
  std::vector<const ReportedFactor*> agreeing;  ///< loops, see neighbouringLoops()
  int disagreeing = 0;                          ///< neighbouring loops
  WeightLoss loss;
  std::unique_ptr<ceres::CostFunction> function;
  std::vector<double*> parameters;
  ceres::ResidualBlockId block = nullptr;     ///< null where the weight is 0
  std::function<Eigen::VectorXd()> residual;  ///< without whitening, at the present estimate

  bool isLoop() const { return kind == FactorReport::Kind::Loop; }
  bool isUsed() const { return loss.weight > 0.0; }
};

/// The parameters and residuals of a pose graph as a problem of Ceres, and the directions that are held. It
/// lives as long as its graph. Factors of weight 0 are not in the problem, so that they fill in no matrix.
class GraphProblem {
 public:
  GraphProblem();

  void addNode(KeyframeId id, int dive, const Rigid3& world_from_body);
  void add(const GraphEdge& edge);
  void add(const TiltMeasurement& measurement);
  void add(const HeadingMeasurement& measurement);
  void add(const HeightMeasurement& measurement);
  void add(const PositionMeasurement& measurement);
  void add(const GraphLandmark& landmark);
  void add(const LandmarkObservation& observation);
  void add(const AzimuthPrior& prior);
  void add(const OriginDepth& depth);
  void add(const SurfaceHeight& surface);

  /// Holds what the measurements leave open, see PoseGraph. To be called before each solution.
  void hold();
  ceres::Solver::Summary solve(int most_iterations);
  /// Sets the weight of a factor; 0 takes it out of the problem.
  void setWeight(ReportedFactor* factor, double weight);
  /// Places the nodes of each chain by odometry, from its first node.
  void restoreChains();
  double chiSquared(const ReportedFactor& factor) const;
  std::shared_ptr<const GraphCovariance::Factorization> factorization();

  std::deque<ReportedFactor>& reported() { return reported_; }
  const std::vector<GraphEdge>& certainEdges() const { return certain_edges_; }
  const OdometryChains& chains() const { return chains_; }
  bool contains(KeyframeId id) const { return nodes_.count(id) > 0; }
  size_t size() const { return nodes_.size(); }
  Rigid3 pose(KeyframeId id) const;
  std::map<KeyframeId, Rigid3> poses() const;
  Vec3 landmark(const std::string& name) const;
  double azimuth(int dive) const;
  double heightOffset(int dive) const;
  double surfaceHeight() const { return surface_.value; }
  std::optional<double> azimuthSigma(int dive) const;
  std::optional<double> originDepthSigma(int dive) const;

 private:
  struct Node {
    std::array<double, kPoseSize> pose{};
    int dive = 0;
    std::unique_ptr<Prior> weak;  ///< of the first node of a part
    std::vector<int> free_axes{0, 1, 2, 3, 4, 5};
    KeyframeId part = -1;  ///< a node of the same part, nearer to its first node
  };
  /// A number that is common to a dive, or to all of them, with its prior.
  struct CommonNumber {
    double value = 0.0;
    Prior prior;
    bool is_measured = false;
  };
  struct LandmarkState {
    Vec3 position_W = Vec3::Zero();
    Prior prior;
    bool is_measured = false;
    int observations = 0;
    KeyframeId part = -1;  ///< a node that sees it for certain
  };

  Node& node(KeyframeId id, const char* what);
  const Node& node(KeyframeId id) const;
  CommonNumber& numberOf(int dive, double first_value, double weak_sigma,
                         std::map<int, CommonNumber>* numbers);
  void start(CommonNumber* number, double first_value, double weak_sigma);
  static void setPrior(double value, double sigma, const char* what, CommonNumber* number);
  ReportedFactor& report(FactorReport::Kind kind, bool is_robust, KeyframeId node, int degrees_of_freedom);
  void addCertain(std::unique_ptr<ceres::CostFunction> function, const std::vector<double*>& parameters);
  KeyframeId partOf(KeyframeId id);
  void join(KeyframeId a, KeyframeId b);
  void addMeasuredPosition(const Vec3& position_W);
  std::vector<int> openAxes() const;

  // The problem refers to everything below. Maps and deques keep the addresses of their elements.
  std::map<KeyframeId, Node> nodes_;
  std::map<int, CommonNumber> azimuths_, height_offsets_;
  CommonNumber surface_;  ///< height in W, m
  std::map<int, OriginDepthFactor*> origin_depths_;
  std::map<std::string, LandmarkState> landmarks_;
  std::deque<ReportedFactor> reported_;
  std::vector<std::unique_ptr<ceres::CostFunction>> functions_;  ///< of all other factors
  std::vector<GraphEdge> certain_edges_;
  OdometryChains chains_;
  std::vector<std::unique_ptr<ceres::Manifold>> manifolds_;
  bool has_tilt_ = false;
  KeyframeId held_ = -1;                    ///< the first node at the first solution
  std::vector<Vec3> measured_positions_W_;  ///< at most two that are apart
  std::unique_ptr<ceres::Problem> problem_;
};

}  // namespace lodeline
