#include "lodeline/mapping/graph/graph_problem.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

#include "lodeline/diagnostics.h"
#include "lodeline/mapping/graph/factors/heading_factor.h"
#include "lodeline/mapping/graph/factors/height_factor.h"
#include "lodeline/mapping/graph/factors/landmark_observation_factor.h"
#include "lodeline/mapping/graph/factors/position_factor.h"
#include "lodeline/mapping/graph/factors/relative_pose_factor.h"
#include "lodeline/mapping/graph/factors/tilt_factor.h"
#include "lodeline/mapping/graph/graph_gauge.h"
#include "lodeline/mapping/graph/motion/level_motion.h"

namespace lodeline {
namespace {

ceres::Problem::Options problemOptions() {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.enable_fast_removal = true;
  return options;
}

template <typename Numbers>
double numberFor(int dive, const Numbers& numbers, const char* what) {
  const auto found = numbers.find(dive);
  if (found == numbers.end()) throw InputError(fmt::format("dive {} has no {} in the graph", dive, what));
  return found->second.value;
}

}  // namespace

GraphProblem::GraphProblem() : problem_(std::make_unique<ceres::Problem>(problemOptions())) {
  manifolds_.push_back(std::make_unique<PoseManifold>());
}

void GraphProblem::addNode(KeyframeId id, int dive, const Rigid3& world_from_body) {
  checkPose(world_from_body, fmt::format("node {}", id).c_str());
  const auto [place, is_new] = nodes_.try_emplace(id);
  if (!is_new) throw InputError(fmt::format("node {} is already in the graph", id));
  Node& added = place->second;
  added.dive = dive;
  added.part = id;
  poseToBlock(world_from_body, added.pose.data());
  problem_->AddParameterBlock(added.pose.data(), kPoseSize, manifolds_.front().get());
}

void GraphProblem::add(const GraphEdge& edge) {
  const std::string what = fmt::format("edge of nodes {} and {}", edge.from, edge.to);
  if (edge.from == edge.to) throw InputError(what + ": both are the same");
  Node& from = node(edge.from, what.c_str());
  Node& to = node(edge.to, what.c_str());
  auto factor = std::make_unique<RelativePoseFactor>(edge.relative);
  if (!edge.robust) {
    join(edge.from, edge.to);
    chains_.add(edge.from, edge.to, edge.relative);
    certain_edges_.push_back(edge);
    addCertain(std::move(factor), {from.pose.data(), to.pose.data()});
    return;
  }
  ReportedFactor& loop = report(FactorReport::Kind::Loop, true, edge.from, 6);
  loop.to = edge.to;
  loop.relative = edge.relative;
  loop.residual = [measured = edge.relative.from_from_to, &from, &to]() -> Eigen::VectorXd {
    return errorBetween(measured, poseFromBlock(from.pose.data()).inverse() * poseFromBlock(to.pose.data()));
  };
  loop.function = std::move(factor);
  loop.parameters = {from.pose.data(), to.pose.data()};
}

void GraphProblem::add(const TiltMeasurement& measurement) {
  Node& tilted = node(measurement.node, "tilt");
  addCertain(std::make_unique<TiltFactor>(measurement.up_B, measurement.sigma_rad), {tilted.pose.data()});
  has_tilt_ = true;
}

void GraphProblem::add(const HeadingMeasurement& measurement) {
  Node& headed = node(measurement.node, "heading");
  auto factor = std::make_unique<HeadingFactor>(measurement.odom_from_body, measurement.sigma_rad);
  const double present =
      azimuthOf(poseFromBlock(headed.pose.data()).rotation * measurement.odom_from_body.conjugate());
  CommonNumber& azimuth = numberOf(headed.dive, present, kWeakRotation_rad, &azimuths_);
  addCertain(std::move(factor), {headed.pose.data(), &azimuth.value});
}

void GraphProblem::add(const HeightMeasurement& measurement) {
  Node& high = node(measurement.node, "height");
  auto factor = std::make_unique<HeightFactor>(measurement.height_m, measurement.sigma_m);
  CommonNumber& offset =
      numberOf(high.dive, measurement.height_m - high.pose[2], kWeakPosition_m, &height_offsets_);
  addCertain(std::move(factor), {high.pose.data(), &offset.value});
}

void GraphProblem::add(const PositionMeasurement& measurement) {
  const std::string what = fmt::format("position '{}'", measurement.name);
  Node& placed = node(measurement.node, what.c_str());
  auto factor =
      std::make_unique<PositionFactor>(measurement.position_W, measurement.covariance, measurement.point_B);
  ReportedFactor& reported = report(FactorReport::Kind::Position, measurement.robust, measurement.node, 3);
  reported.name = measurement.name;
  reported.residual = [measurement, &placed]() -> Eigen::VectorXd {
    return poseFromBlock(placed.pose.data()) * measurement.point_B - measurement.position_W;
  };
  reported.function = std::move(factor);
  reported.parameters = {placed.pose.data()};
  if (!measurement.robust) setWeight(&reported, 1.0);
  addMeasuredPosition(measurement.position_W);
}

void GraphProblem::add(const GraphLandmark& landmark) {
  const std::string what = fmt::format("landmark '{}'", landmark.name);
  if (landmark.position_W) {
    checkCovariance(landmark.covariance, what.c_str());
    if (!landmark.position_W->allFinite()) throw InputError(what + ": its position is not finite");
  }
  const auto [place, is_new] = landmarks_.try_emplace(landmark.name);
  if (!is_new) throw InputError(what + " is already in the graph");
  LandmarkState& state = place->second;
  state.is_measured = landmark.position_W.has_value();
  if (state.is_measured) state.position_W = *landmark.position_W;
  state.prior.append(state.position_W.data(), 3, Vec3::Constant(kWeakPosition_m));
  if (state.is_measured) {
    const Eigen::LLT<Eigen::MatrixXd> information(landmark.covariance.inverse());
    state.prior.sqrt_information = information.matrixU();
  }
  addCertain(std::make_unique<PriorFactor>(state.prior), {state.position_W.data()});
}

void GraphProblem::add(const LandmarkObservation& observation) {
  const std::string what = fmt::format("observation of '{}'", observation.landmark);
  Node& from = node(observation.node, what.c_str());
  const auto found = landmarks_.find(observation.landmark);
  if (found == landmarks_.end()) throw InputError(what + ": no such landmark is in the graph");
  LandmarkState& seen = found->second;
  auto factor = std::make_unique<LandmarkObservationFactor>(observation.point_B, observation.covariance);
  if (seen.observations++ == 0) {
    if (seen.is_measured) {
      addMeasuredPosition(seen.position_W);
    } else {
      seen.position_W = poseFromBlock(from.pose.data()) * observation.point_B;
      seen.prior.blocks[0].linearization_point = seen.position_W;
    }
  }
  if (!observation.robust) {
    if (seen.part >= 0) join(seen.part, observation.node);
    seen.part = observation.node;
  }
  ReportedFactor& reported =
      report(FactorReport::Kind::LandmarkObservation, observation.robust, observation.node, 3);
  reported.name = observation.landmark;
  reported.residual = [measured = observation.point_B, &from, &seen]() -> Eigen::VectorXd {
    return poseFromBlock(from.pose.data()).inverse() * seen.position_W - measured;
  };
  reported.function = std::move(factor);
  reported.parameters = {from.pose.data(), seen.position_W.data()};
  if (!observation.robust) setWeight(&reported, 1.0);
}

void GraphProblem::add(const AzimuthPrior& prior) {
  setPrior(prior.azimuth_rad, prior.sigma_rad, "azimuth of a dive",
           &numberOf(prior.dive, prior.azimuth_rad, kWeakRotation_rad, &azimuths_));
}

void GraphProblem::add(const OriginDepth& depth) {
  const auto known = origin_depths_.find(depth.dive);
  if (known != origin_depths_.end()) return known->second->set(depth.depth_m, depth.sigma_m);
  auto factor = std::make_unique<OriginDepthFactor>(depth.depth_m, depth.sigma_m);
  origin_depths_[depth.dive] = factor.get();
  CommonNumber& offset = numberOf(depth.dive, 0.0, kWeakPosition_m, &height_offsets_);
  start(&surface_, depth.depth_m - offset.value, kWeakPosition_m);
  addCertain(std::move(factor), {&offset.value, &surface_.value});
}

void GraphProblem::add(const SurfaceHeight& surface) {
  start(&surface_, surface.height_m, kWeakPosition_m);
  setPrior(surface.height_m, surface.sigma_m, "height of the surface", &surface_);
}

GraphProblem::CommonNumber& GraphProblem::numberOf(int dive, double first_value, double weak_sigma,
                                                   std::map<int, CommonNumber>* numbers) {
  CommonNumber& number = (*numbers)[dive];
  start(&number, first_value, weak_sigma);
  return number;
}

void GraphProblem::start(CommonNumber* number, double first_value, double weak_sigma) {
  if (!number->prior.blocks.empty()) return;
  number->value = first_value;
  number->prior.append(&number->value, 1, Eigen::VectorXd::Constant(1, weak_sigma));
  addCertain(std::make_unique<PriorFactor>(number->prior), {&number->value});
}

void GraphProblem::setPrior(double value, double sigma, const char* what, CommonNumber* number) {
  if (!std::isfinite(value) || !(sigma > 0.0) || !std::isfinite(sigma)) {
    throw InputError(fmt::format("{}: the value must be finite and sigma positive", what));
  }
  number->prior.blocks[0].linearization_point[0] = value;
  number->prior.sqrt_information(0, 0) = 1.0 / sigma;
  if (!number->is_measured) number->value = value;
  number->is_measured = true;
}

ReportedFactor& GraphProblem::report(FactorReport::Kind kind, bool is_robust, KeyframeId node,
                                     int degrees_of_freedom) {
  ReportedFactor& added = reported_.emplace_back();
  added.kind = kind;
  added.is_robust = is_robust;
  added.from = node;
  added.degrees_of_freedom = degrees_of_freedom;
  added.loss.weight = 0.0;
  return added;
}

void GraphProblem::addCertain(std::unique_ptr<ceres::CostFunction> function,
                              const std::vector<double*>& parameters) {
  problem_->AddResidualBlock(function.get(), nullptr, parameters);
  functions_.push_back(std::move(function));
}

GraphProblem::Node& GraphProblem::node(KeyframeId id, const char* what) {
  const auto found = nodes_.find(id);
  if (found == nodes_.end()) throw InputError(fmt::format("{}: node {} is not in the graph", what, id));
  return found->second;
}

const GraphProblem::Node& GraphProblem::node(KeyframeId id) const {
  const auto found = nodes_.find(id);
  if (found == nodes_.end()) throw InputError(fmt::format("node {} is not in the graph", id));
  return found->second;
}

Rigid3 GraphProblem::pose(KeyframeId id) const { return poseFromBlock(node(id).pose.data()); }

std::map<KeyframeId, Rigid3> GraphProblem::poses() const {
  std::map<KeyframeId, Rigid3> poses;
  for (const auto& [id, state] : nodes_) poses.emplace(id, poseFromBlock(state.pose.data()));
  return poses;
}

Vec3 GraphProblem::landmark(const std::string& name) const {
  const auto found = landmarks_.find(name);
  if (found == landmarks_.end()) throw InputError(fmt::format("landmark '{}' is not in the graph", name));
  return found->second.position_W;
}

double GraphProblem::azimuth(int dive) const { return numberFor(dive, azimuths_, "heading"); }
double GraphProblem::heightOffset(int dive) const { return numberFor(dive, height_offsets_, "height"); }

std::optional<double> GraphProblem::azimuthSigma(int dive) const {
  const auto found = azimuths_.find(dive);
  if (found == azimuths_.end() || !found->second.is_measured) return std::nullopt;
  return 1.0 / found->second.prior.sqrt_information(0, 0);
}

std::optional<double> GraphProblem::originDepthSigma(int dive) const {
  const auto found = origin_depths_.find(dive);
  if (found == origin_depths_.end()) return std::nullopt;
  return found->second->sigma_m();
}

}  // namespace lodeline
